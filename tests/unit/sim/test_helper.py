"""A thread that works when it is told to: results, errors, interruptions."""

from threading import Event

import pytest

from edl6dof.sim.fleet import Helper


def test_work_is_done_once_for_each_time_it_is_told():
    given = []
    helper = Helper(given.append)
    for number in (3, 1, 2):
        helper.begin(number)
        helper.wait()
    helper.close()
    assert given == [3, 1, 2]


def test_what_the_work_raised_is_raised_where_it_is_waited_for_and_the_thread_lives_on():
    helper = Helper(lambda number: 1 // number)
    helper.begin(0)
    with pytest.raises(ZeroDivisionError):
        helper.wait()
    helper.begin(1)
    helper.wait()
    helper.close()


def test_who_did_not_wait_gets_the_next_work_done_after_the_first():
    """As after Ctrl-C in the middle of waiting."""
    given, may_end = [], Event()

    def work(number):
        may_end.wait(60.0)
        given.append(number)

    helper = Helper(work)
    helper.begin(1)
    may_end.set()
    helper.begin(2)
    helper.wait()
    helper.close()
    assert given == [1, 2]


def test_a_closed_helper_refuses_work():
    helper = Helper(print)
    helper.close()
    helper.close()
    with pytest.raises(RuntimeError, match="closed"):
        helper.begin(1)
