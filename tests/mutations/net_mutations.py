"""Links between servers: who believes whom, and what strangers can do."""

from mutation import NET, REGION, Mutation

HANDSHAKE, LINKS = "server/net/links/handshake.cpp", "server/net/links/peer_links.cpp"

MUTATIONS = [
    Mutation(
        "proof-to-anybody",
        "a proof does not say to whom it was made",
        HANDSHAKE,
        "const std::uint16_t to = answering_.value;",
        "const std::uint16_t to = 0;",
        ((NET, "a proof to one server proves nothing to another one"),),
    ),
    Mutation(
        "proof-of-either-side",
        "a proof does not say which side made it",
        HANDSHAKE,
        "std::byte(sender == Side::dials ? 'd' : 'a')",
        "std::byte(sender == sender ? 'd' : 'a')",
        ((NET, "a proof is of one side, and cannot be sent back to it"),),
    ),
    Mutation(
        "proof-for-ever",
        "a proof does not depend on the challenge",
        HANDSHAKE,
        "mac({head, *answering_nonce_, dialling, payload})",
        "mac({head, dialling, payload})",
        ((NET, "a proof that somebody has listened to is worth nothing on another connection"),),
    ),
    Mutation(
        "code-for-strangers",
        "who has proven nothing is answered with a code, on which secrets can be tried",
        HANDSHAKE,
        "  const auto type = static_cast<FrameType>(sealed->type());",
        "  dialling_nonce_ = dialling;\n  const auto type = static_cast<FrameType>(sealed->type());",
        ((NET, "a proof to one server proves nothing to another one"),),
    ),
    Mutation(
        "replaced-by-a-stranger",
        "who has proven nothing can end a server that dials it",
        LINKS,
        "      refusal.replaced &= opened->is_proven;\n",
        "",
        ((NET, "only who has proven that it knows the secret says that a server has been replaced"),),
    ),
    Mutation(
        "replaced-on-a-link",
        "a word without a proof can end a server over a link that stands",
        LINKS,
        "take_refusal(peer, frame, !options.secret)",
        "take_refusal(peer, frame, true)",
        ((NET, "on a link, too, only who proves it says that a server has been replaced"),),
    ),
    Mutation(
        "sealed-refusal-unheard",
        "a server that was dialled does not hear that it has been replaced",
        LINKS,
        "if (*peer && frame.type == FrameType::sealed)",
        "if (false)",
        ((NET, "a server that is dialled is told that it has been replaced, with a secret and without"),),
    ),
    Mutation(
        "strangers-keep-out",
        "strangers that say nothing keep their places",
        LINKS,
        'oldest->close("it did not introduce itself before many others came");',
        "static_cast<void>(oldest);",
        ((NET, "strangers that say nothing, however many, keep no server out"),),
    ),
    Mutation(
        "journal-without-end",
        "what a receiver takes and never makes durable is kept for ever",
        "server/region/handoff/journal.cpp",
        "kept > taken_max || taken_bytes_ > taken_bytes_max",
        "false && kept > 0",
        ((REGION, "of what a receiver takes and never makes durable the oldest is let go, nothing untaken is"),
         (REGION, "the bytes of what is taken and not durable are bounded, too")),
    ),
]
