"""What a mutation is: a mechanism that correctness rests on, and the tests that must notice."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Mutation:
    """`file` is changed by replacing `old`, which must occur exactly once, with `new`. `killers` are
    names of test cases (Catch2 patterns) of a target; at least one must fail. A mutation whose text
    is no longer there is an error: then the mechanism has changed, and its mutation has to follow.
    """

    name: str
    what: str
    file: str
    old: str
    new: str
    killers: tuple  # of (target, test case)


REGION = "test_region"
AURA = "test_aura"
NET = "test_net"
PHYSICS = "physics_test"
