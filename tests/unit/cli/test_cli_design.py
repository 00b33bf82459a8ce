"""What ``edl6dof design landing`` refuses before it flies."""

from cli_run import run


def test_command_refuses_what_it_cannot_design(capsys, monkeypatch, tmp_path):
    status, _, said = run(capsys, monkeypatch, "design", "landing", "msl")
    assert status == 2
    assert "guidance: powered" in said
    status, _, said = run(
        capsys, monkeypatch, "design", "landing", "tianwen1", "--out", str(tmp_path / "x.txt")
    )
    assert status == 2
    assert ".csv" in said


def test_command_says_how_to_get_cvxpy(capsys, monkeypatch):
    monkeypatch.setattr("edl6dof.cli.designs.find_spec", lambda name: None)
    status, _, said = run(capsys, monkeypatch, "design", "landing", "tianwen1")
    assert status == 69
    assert "edl6dof[design]" in said
