"""The learning environments keep gymnasium's word, and fly what a flight flies."""

import builtins
import copy
import importlib
import pickle
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest

gymnasium = pytest.importorskip("gymnasium")

from gymnasium.utils.env_checker import check_env  # noqa: E402
from gymnasium.vector import AutoresetMode  # noqa: E402

import edl6dof.gym as gym  # noqa: E402
from edl6dof.gym.environments import task_called  # noqa: E402
from edl6dof.gym.episodes import StartPool  # noqa: E402


@pytest.fixture(scope="module")
def environments():
    """One of each task, whose flights to the beginning are flown once."""
    return {name: gym.FlightEnv(name, pool=1) for name in gym.TASKS}


def episode(env, policy, seed=0):
    """Return, whether done, and the last observation."""
    seen, _ = env.reset(seed=seed)
    total, over, cut_off = 0.0, False, False
    while not (over or cut_off):
        seen, reward, over, cut_off, information = env.step(policy(env))
        total += reward
    return total, information["is_success"], seen


@pytest.mark.parametrize("name", gym.TASKS)
def test_environment_keeps_gymnasiums_word(environments, name):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", message=".*not within the observation space bounds.*gymnasium.make")
        check_env(environments[name], skip_render_check=True)


@pytest.mark.parametrize("name", gym.TASKS)
def test_flight_software_itself_does_the_task(environments, name):
    total, done, seen = episode(environments[name], lambda env: env.baseline())
    assert done
    assert total > 0.0
    assert np.isfinite(seen).all()


#: Not of HazardDivert, where a spot chosen blindly is safe more often than not.
IDLE = {
    "EntryBank": lambda env: np.zeros(1, np.float32),  # lift up all the way
    "PoweredDescent": lambda env: np.zeros(3, np.float32),  # thrust against the weight alone
    "DeadThruster": lambda env: -np.ones(22, np.float32),  # no thruster at all
    "FaultDiagnosis": lambda env: 22,  # one that works
}


@pytest.mark.parametrize("name", IDLE)
def test_doing_nothing_about_it_does_not(environments, name):
    total, done, _ = episode(environments[name], IDLE[name])
    assert not done
    assert total < 1.0


@pytest.mark.parametrize("name", ["PoweredDescent", pytest.param("HazardDivert", marks=pytest.mark.long)])
def test_same_seed_and_actions_are_the_same_episode(name):
    env = gym.FlightEnv(name, pool=2)

    def seen(seed):
        first = env.reset(seed=seed)[0]
        env.action_space.seed(seed)
        return [first, *(env.step(env.action_space.sample())[0] for _ in range(5))]

    first = seen(5)
    assert np.array_equal(first, seen(5))
    assert not np.array_equal(first[0], seen(6)[0])


def test_many_flights_are_as_many_single_ones():
    many = gym.FlightVectorEnv("PoweredDescent", 3, pool=2, workers=2)
    single = gym.FlightEnv("PoweredDescent", pool=2)
    rng = np.random.default_rng(0)
    actions = rng.uniform(-0.3, 0.3, (10, 3, 3)).astype(np.float32)
    seen = [many.reset(seed=7)[0]]
    rewards = []
    for action in actions:
        one, reward, *_ = many.step(action)
        seen.append(one)
        rewards.append(reward)
    for k in range(3):
        alone = [single.reset(seed=7 + k)[0]]
        for action, reward in zip(actions[:, k], rewards, strict=True):
            one, value, *_ = single.step(action)
            alone.append(one)
            assert value == reward[k]
        assert np.array_equal(alone, np.array(seen)[:, k])
    many.close()


@pytest.fixture(scope="module")
def diagnosis():
    """An environment with a pool of two cases from case 3 on."""
    return gym.FlightEnv("FaultDiagnosis", pool=2, first_case=3)


def test_an_episode_draws_from_its_pool_alone(diagnosis):
    own = [diagnosis.reset(options={"case": case})[0] for case in (3, 4)]
    for seed in range(12):
        begun = diagnosis.reset(seed=seed)[0]
        assert any(np.array_equal(begun, one) for one in own)


def test_cases_are_those_of_any_other_pool(diagnosis):
    other = gym.FlightEnv("FaultDiagnosis", pool=1)
    assert np.array_equal(other.reset(options={"case": 3})[0], diagnosis.reset(options={"case": 3})[0])
    assert not np.array_equal(other.reset(seed=0)[0], diagnosis.reset(options={"case": 3})[0])


def test_a_case_that_ends_early_is_replaced_by_one_of_no_pool(monkeypatch):
    """The beginning of a task is reached at the second try."""
    asked = []
    pool = StartPool(task_called("FaultDiagnosis"), 2, 0)
    begin = pool.flights.at_phase

    def second_comes(case, *about):
        asked.append(case)
        return begin(case, *about) if len(asked) > 1 else None

    monkeypatch.setattr(pool.flights, "at_phase", second_comes)
    pool[1]
    first, second = asked
    assert first == 1
    with pytest.raises(ValueError, match="a case must be a whole number from 0"):
        pool[second]


@pytest.mark.parametrize("case", [-1, 2**26, 1.0, True, "1"])
def test_a_case_that_is_none_is_refused(diagnosis, case):
    with pytest.raises(ValueError, match="a case must be a whole number from 0"):
        diagnosis.reset(options={"case": case})


@pytest.mark.parametrize(
    "pool, first_case", [(0, 0), (-1, 0), (1, -1), (2, 2**26 - 1), (1.5, 0), (True, 0), (2, "0")]
)
def test_a_pool_that_is_none_is_refused(pool, first_case):
    with pytest.raises(ValueError, match="pool must be at least 1"):
        gym.FlightEnv("FaultDiagnosis", pool=pool, first_case=first_case)


def test_an_option_that_is_none_is_refused(diagnosis):
    with pytest.raises(ValueError, match="did you mean 'case'"):
        diagnosis.reset(options={"cases": 1})
    with pytest.raises(ValueError, match="no option 'case'"):
        gym.FlightVectorEnv("FaultDiagnosis", 1).reset(options={"case": 1})


BAD_NUMBERS = [[np.nan] * 22, [np.inf] * 22, [0.0] * 21, 0.0, ["up"] * 22]


@pytest.mark.parametrize(
    "name, action",
    [("DeadThruster", bad) for bad in BAD_NUMBERS] + [("FaultDiagnosis", n) for n in (-1, 23, 1.0)],
)
def test_an_action_that_is_none_is_refused(environments, name, action):
    env = environments[name]
    env.reset(seed=0)
    with pytest.raises(ValueError, match="action"):
        env.step(action)


def test_a_number_beyond_its_bound_counts_as_the_bound(environments):
    env = environments["PoweredDescent"]
    seen = []
    for action in ([1.0, -1.0, 1.0], [7.0, -1e9, 1.5]):
        env.reset(seed=0)
        seen.append(np.array([env.step(action)[0] for _ in range(3)]))
    assert np.array_equal(*seen)


def ended(mode):
    """A diagnosis whose first flight names a thruster, which ends its episode."""
    env = gym.FlightVectorEnv("FaultDiagnosis", 2, pool=1, autoreset_mode=mode)
    begun, _ = env.reset(seed=1)
    return env, begun, env.step(np.array([22, 0]))


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env))])
@pytest.mark.parametrize("name", gym.TASKS)
def test_a_copy_flies_on_as_its_original_and_apart_from_it(environments, name, copied):
    env = environments[name]
    env.reset(seed=3)
    for _ in range(3):
        env.step(env.baseline())
    other = copied(env)
    action = env.baseline()
    (seen, *results), (seen_of_copy, *results_of_copy) = env.step(action), other.step(action)
    assert np.array_equal(seen, seen_of_copy) and results == results_of_copy
    env.step(env.baseline())
    assert np.array_equal(other.baseline(), copied(other).baseline())
    assert np.array_equal(env.reset()[0], other.reset()[0])  # their generators stand where they stood


def test_a_copy_of_many_flights_flies_on_as_its_original():
    envs = gym.FlightVectorEnv("PoweredDescent", 3, pool=2, workers=2)
    envs.reset(seed=1)
    envs.step(envs.baseline())
    other = pickle.loads(pickle.dumps(envs))
    assert np.array_equal(envs.step(envs.baseline())[0], other.step(other.baseline())[0])


def test_an_episode_begins_anew_in_the_next_step():
    env, begun, (seen, reward, over, cut_off, information) = ended(AutoresetMode.NEXT_STEP)
    assert over.tolist() == [True, False] and not cut_off.any()
    assert reward.tolist() == [-1.0, 0.0]
    assert information["_is_success"].tolist() == [True, False]
    seen, reward, over, *_ = env.step(np.array([22, 0]))
    assert np.array_equal(seen[0], begun[0])
    assert (reward[0], over[0]) == (0.0, False)


def test_an_episode_begins_anew_in_the_same_step():
    _, begun, (seen, _, over, _, information) = ended("SameStep")
    assert over.tolist() == [True, False]
    assert np.array_equal(seen[0], begun[0])
    assert not np.array_equal(information["final_obs"][0], begun[0])
    assert information["final_obs"][1] is None


def test_an_episode_begins_anew_when_it_is_told():
    env, begun, (seen, _, over, *_) = ended(AutoresetMode.DISABLED)
    with pytest.raises(ValueError, match=r"episodes \[0\] have ended"):
        env.step(np.array([0, 0]))
    again, _ = env.reset(options={"reset_mask": over})
    assert np.array_equal(again[0], begun[0])
    assert np.array_equal(again[1], seen[1])
    with pytest.raises(ValueError, match="reset_mask must have 2 values"):
        env.reset(options={"reset_mask": np.array([True])})


def test_gymnasium_makes_them_by_name():
    env = gymnasium.make("edl6dof/EntryBank-v0", pool=1)
    assert env.observation_space.contains(env.reset(seed=1)[0])
    many = gymnasium.make_vec("edl6dof/EntryBank-v0", num_envs=2, pool=1)
    assert many.reset(seed=1)[0].shape == (2, *env.observation_space.shape)


def test_observation_holds_no_truth(environments):
    """It is made of the memories of the flight computers alone."""
    env = environments["PoweredDescent"]
    env.reset(seed=0)
    before = env.task.observe()
    env.task.fleet.plants["y"] += 1.0
    env.task.fleet.outputs["height"] = 0.0
    assert np.array_equal(env.task.observe(), before)


def test_a_task_that_is_none_is_refused():
    with pytest.raises(ValueError, match="did you mean 'EntryBank'"):
        task_called("EntryBanc")


def test_without_gymnasium_it_says_what_to_install(monkeypatch):
    load = builtins.__import__

    def without(name, *more, **named):
        if name == "gymnasium":
            raise ImportError(name)
        return load(name, *more, **named)

    monkeypatch.setattr(builtins, "__import__", without)
    monkeypatch.delitem(sys.modules, "edl6dof.gym")
    with pytest.raises(ImportError, match=r"edl6dof\[gym\]"):
        importlib.import_module("edl6dof.gym")


def test_units_and_scales_are_printed_and_documented(environments):
    page = (Path(__file__).parents[2] / "docs" / "stepping.md").read_text(encoding="utf-8")
    for name, env in environments.items():
        printed = str(env.task)
        for feature in env.task.features:
            assert f"  {feature.name} / {feature.scale_and_unit}" in printed
            assert f"| `{feature.name}` | {feature.scale_and_unit} | {feature.size} |" in page
        assert "The action is " in printed and f"\n| `{name}` | " in page


def test_the_bank_of_an_action_of_one_is_the_documented_one(environments):
    assert np.degrees(environments["EntryBank"].task._largest) == pytest.approx(105.0)


def test_only_a_window_can_be_rendered():
    with pytest.raises(ValueError, match="rgb_array"):
        gym.FlightEnv("EntryBank", render_mode="rgb_array")
