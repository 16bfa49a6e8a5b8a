"""What a step of physics rests on (server/physics)."""

from mutation import PHYSICS, Mutation

MUTATIONS = [
    Mutation(
        "pair-order",
        "pairs are walked through from the lowest ids up, not as Bullet has it",
        "server/physics/bullet/parts/pair_order.cpp",
        "return a.key < b.key; };",
        "return b.key < a.key; };",
        ((PHYSICS, "Whoever comes and goes, pairs are walked through in Bullet's order"),
         (PHYSICS, "What falls onto a heap falls as in Bullet's own world")),
    ),
    Mutation(
        "pair-in-anothers-place",
        "a pair that lies where another one lay is taken for it",
        "server/physics/bullet/parts/pair_order.cpp",
        "    if (at < known && keys_[at] == key) continue;\n",
        "    if (at < known) continue;\n",
        ((PHYSICS, "A pair that has another's place is not taken for it"),
         (PHYSICS, "Whoever comes and goes, pairs are walked through in Bullet's order")),
    ),
    Mutation(
        "woken-stand-still",
        "who has been woken by what it hangs together with is not moved in that step",
        "server/physics/bullet/parts/dynamics_world.cpp",
        "find_awake(awake_now_);",
        "awake_now_ = awake_;",
        ((PHYSICS, "What falls onto a heap falls as in Bullet's own world"),),
    ),
]
