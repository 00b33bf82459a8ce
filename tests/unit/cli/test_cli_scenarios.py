"""``edl6dof scenarios``."""

from __future__ import annotations

from cli_run import ROOT, run

from edl6dof.config.document.locate import shipped_names


def test_every_shipped_scenario_is_listed_with_what_it_is(capsys, monkeypatch):
    code, out, err = run(capsys, monkeypatch, "scenarios")
    assert (code, err) == (0, "")
    rows = {words[0]: words[1:] for line in out.splitlines() if len(words := line.split()) > 1}
    assert all(rows.get(name) for name in shipped_names("scenarios"))


def test_a_printed_scenario_is_a_file_to_begin_with(capsys, monkeypatch, tmp_path):
    code, out, _ = run(capsys, monkeypatch, "scenarios", "tianwen1")
    assert code == 0 and out == (ROOT / "scenarios" / "tianwen1.yaml").read_text(encoding="utf-8")
    mine = tmp_path / "mine.yaml"
    mine.write_text(out.replace("speed_m_s: 4800.24", "speed_m_s: 4700.0"), encoding="utf-8")
    assert run(capsys, monkeypatch, "check", str(mine))[0] == 0


def test_one_that_is_not_there_is_refused(capsys, monkeypatch):
    code, out, err = run(capsys, monkeypatch, "scenarios", "tianwen2")
    assert (code, out) == (2, "") and "did you mean tianwen1" in err
