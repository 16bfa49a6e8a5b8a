"""The mechanisms that correctness rests on, each with the change that breaks it and the tests that
must notice.

`file` is changed by replacing `old`, which must occur exactly once, with `new`. `killers` are names
of test cases (Catch2 patterns) of `target`; at least one must fail. A mutation whose text is no
longer there is an error: then the mechanism has changed, and its mutation has to follow.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Mutation:
    name: str
    what: str
    file: str
    old: str
    new: str
    killers: tuple  # of (target, test case)


REGION = "test_region"
AURA = "test_aura"

MUTATIONS = [
    Mutation(
        "version-check",
        "a region that recovers claims what it knows of, whatever version others have",
        "server/region/recovery/recovery.cpp",
        "      known.newest = std::max(known.newest, trace.version);",
        "      known.newest = std::max(known.newest, Version{});",
        ((REGION, "a sender that dies after its group was accepted does not claim it"),
         (REGION, "whatever dies, no body is lost and none has two owners")),
    ),
    Mutation(
        "message-taken-once",
        "a message that is sent again is taken again",
        "server/region/handoff/journal.cpp",
        "  if (sequence <= taken_) return Arrival::repeated;\n",
        "",
        ((REGION, "a group is not doubled when the link is reset after it arrived*"),
         (REGION, "a handoff survives a reset of the link at any moment*")),
    ),
    Mutation(
        "acknowledgement",
        "what was sent counts as taken: after a reset nothing is sent again",
        "server/region/handoff/journal.cpp",
        "  sent_ = peer_taken_;",
        "  sent_ = highest_sent_;",
        ((REGION, "a group is neither lost nor doubled when the link is reset before it arrives"),
         (REGION, "a handoff survives a reset of the link at any moment*")),
    ),
    Mutation(
        "symmetric-rule",
        "of two servers whose bodies meet each sends its own to the other",
        "server/aura/adaptive/contests.cpp",
        "      if (lowest < self) continue;  // It decides.\n",
        "      verdict.to = lowest;\n      all.push_back(std::move(verdict));\n      continue;\n",
        ((AURA, "both servers of a pair look at the same overlap and exactly one moves its body"),
         (REGION, "two servers that see the same overlap do not swap their bodies for ever"),
         (REGION, "both servers see the same overlap at the same tick*")),
    ),
    Mutation(
        "corner-sharing",
        "auras are told only to the regions that they reach into, not to those regions' neighbours",
        "server/aura/audience.cpp",
        "    for (const RegionId around : map.neighbours(reached)) told.add(around);\n",
        "",
        ((AURA, "around a corner, servers that share no overlap*"),
         (REGION, "Fig. 1, N and O*")),
    ),
    Mutation(
        "manifold-transfer",
        "contacts do not travel with a group",
        "server/region/hosting.cpp",
        "  physics_.install_contacts(contacts);\n",
        "",
        ((REGION, "a resting stack handed over awake moves less than a millimetre"),
         (REGION, "a tower that leans hard on its foot*")),
    ),
    Mutation(
        "catch-up",
        "the receiver does not make up for the time in flight",
        "server/region/region_step.cpp",
        "    catch_up(group, {hosting_.definitions(), hosting_.physics(), present, recent, "
        "AvatarTuning{}});\n",
        "    group.tick = present;\n",
        ((REGION, "a flight is not changed by the handoffs on its way, at any latency"),),
    ),
    Mutation(
        "wake-neighbours",
        "what leant on a body that another server takes away is not woken",
        "server/region/stand_ins/stand_ins.cpp",
        "  if (!down.empty()) physics_.remove_stand_ins(down, Wake::touching);",
        "  if (!down.empty()) physics_.remove_stand_ins(down, Wake::nobody);",
        ((REGION, "what leant on a stand-in wakes when its body has left its place"),),
    ),
    Mutation(
        "wake-left-behind",
        "what leant on a body that is handed away is not woken",
        "server/region/hosting.cpp",
        "  physics_.remove(gone);",
        "  physics_.remove(gone, Wake::nobody);",
        ((REGION, "a sleeping support that is handed away*"),
         (REGION, "a support that moves is handed away without a stand-in*")),
    ),
    Mutation(
        "fence-before-take-back",
        "a region that recovers waits for nobody's answer",
        "server/region/recovery/recovery.cpp",
        "      if (!answered || goes_first) names.push_back(name_of(id));",
        "      static_cast<void>(answered || goes_first);",
        ((REGION, "a sender that dies after its group was accepted does not claim it"),
         (REGION, "of two neighbours that are down at once exactly one claims a body that moved"),
         (REGION, "whatever dies, no body is lost and none has two owners")),
    ),
    Mutation(
        "all-stand-ins",
        "every foreign body is a stand-in, whether it rests or moves",
        "server/aura/adaptive/outlook.h",
        "  bool rests(std::uint32_t number) const { return expected_mps(number) <= 0; }",
        "  bool rests(std::uint32_t) const { return true; }",
        ((REGION, "two balls that fly at each other over a boundary bounce off as on one server"),
         (REGION, "a tower on the boundary falls when its foot is struck*")),
    ),
    Mutation(
        "blow-forecast",
        "blows are not passed on through contacts",
        "server/aura/adaptive/blow_forecast.cpp",
        "  if (s.contacts != nullptr) pass_on();\n",
        "",
        ((AURA, "what will be struck through a row of contacts goes along before the blow"),
         (REGION, "a chain of ten bodies across three regions*")),
    ),
    Mutation(
        "durable-acknowledgement",
        "the sender forgets a group as soon as it is taken, before it is durable",
        "server/region/handoff/journal.cpp",
        "entries_.front().sequence <= durable) entries_.pop_front();",
        "entries_.front().sequence <= taken) entries_.pop_front();",
        ((REGION, "a group that was acknowledged an instant before the crash is sent again"),),
    ),
    Mutation(
        "journal-not-resent",
        "handoffs in a snapshot's journal are sent again after a recovery",
        "server/region/recovery/region_recovery.cpp",
        "      if (type == FrameType::commands) journal.append(type, payload);",
        "      if (type != FrameType::effects) journal.append(type, payload);",
        ((REGION, "of two neighbours that are down at once exactly one claims a body that moved"),
         (REGION, "whatever dies, no body is lost and none has two owners"),
         (REGION, "a sender that dies with its group in flight claims it*")),
    ),
    Mutation(
        "whole-clusters",
        "decisions never ask for more than the strip along the boundary",
        "server/aura/adaptive/adaptive_policy.cpp",
        "    if (s.view == nullptr) return true;\n",
        "    if (s.view == nullptr || s.view != nullptr) return true;\n",
        ((REGION, "a chain that reaches deep into its region changes servers whole"),),
    ),
    Mutation(
        "claimed-sleepers",
        "what sleepers lean on is not looked for when a recovery claims them",
        "server/region/hosting.cpp",
        "  find_contacts_of_sleepers(claimed);  // Theirs died with their owner.\n",
        "",
        ((REGION, "a sleeper that was claimed knows what it leans on"),),
    ),
    Mutation(
        "later-epoch-stays",
        "a body that arrives replaces the one that is here, however old it is",
        "server/region/hosting.cpp",
        "      if (it->second.epoch > arriving.epoch) continue;\n",
        "",
        ((REGION, "of two claims to one body the later epoch stays, whichever comes first"),),
    ),
    Mutation(
        "overtaken-requests",
        "requests are met that cannot know that the cluster must not change its owner again",
        "server/aura/adaptive/contests.cpp",
        "    if (situation_->now - settled_now_.at(asked_for) < round_trip_ticks_ &&\n",
        "    if (false &&\n",
        ((AURA, "a request that cannot know that its cluster has changed twice waits*"),),
    ),
    Mutation(
        "gone-visitors",
        "what would come with a body is told only while an aura is near it",
        "server/aura/adaptive/contests.cpp",
        "  remember_visitors();\n}\n",
        "}\n",
        ((AURA, "what would come with a body is told on while*"),),
    ),
    Mutation(
        "unforeseen-blasts",
        "a blast is a surprise",
        "server/region/region_migration.cpp",
        "  foresee_blasts(hosted, now);\n  double",
        "  double",
        ((REGION, "what a blast will throw out of a cut*"),),
    ),
    Mutation(
        "blasts-while-asleep",
        "nothing is decided while all sleep, whatever is going to happen",
        "server/region/region_migration.cpp",
        "!blast_ahead && ",
        "",
        ((REGION, "what a blast will throw far from whoever blasts*"),),
    ),
    Mutation(
        "led-on",
        "whom others have followed goes on to a server that nobody meets yet",
        "server/aura/adaptive/contests.cpp",
        "      if (followed && !meets_lower) verdict.to = self;\n",
        "",
        ((AURA, "who has been followed is not led on*"),),
    ),
    Mutation(
        "silent-newcomer",
        "a link that has come up and brings nothing yet holds back all others",
        "server/region/region_migration.cpp",
        "!waits_for_auras(id.as_region(), peer, now);\n",
        "!waits_for_auras(RegionId{2}, peers_.at(PeerId::region(RegionId{2})), now);\n",
        ((REGION, "a link that has come up, and brings nothing yet, holds nothing back*"),),
    ),
    Mutation(
        "touched-sleepers",
        "a blow is not passed on to sleepers that nothing else has found",
        "server/aura/adaptive/stage.cpp",
        "    if (known == none) known = number_of(situation_->contacts->body_in(slot)).value_or(none);\n",
        "",
        ((AURA, "a decision is the same whether who sleeps is among the hosted bodies or apart"),),
    ),
    Mutation(
        "visited-sleepers",
        "a sleeper is not told of any more as soon as nothing is near it",
        "server/aura/adaptive/contests.cpp",
        "  bring_in_visited();\n",
        "",
        ((AURA, "a decision is the same whether who sleeps is among the hosted bodies or apart"),),
    ),
    Mutation(
        "rested-sleepers",
        "what has fallen asleep counts as having rested for long",
        "server/aura/adaptive/homecoming.cpp",
        "      unrest_.push_back(entry);\n",
        "      {}\n",
        ((AURA, "it is not calm yet where somebody has just fallen asleep"),),
    ),
    Mutation(
        "left-out-decision",
        "a decision whose tick was left out is not made up for",
        "server/region/region_migration.cpp",
        "  return !started_ || now.value / interval != last_tick_.value / interval;",
        "  return !started_ || now.value % interval == 0;",
        ((REGION, "a decision whose tick was left out is made at the next one"),),
    ),
    Mutation(
        "struck-on-its-way",
        "what strikes something reaches as if it went on along its way until then only",
        "server/aura/adaptive/outlook.cpp",
        "      sudden > 0 ? 0.0 : std::clamp(forecast_.left_alone_s(number), 0.0, reach_s_);\n",
        "      reach_s_;\n",
        ((AURA, "a ball that strikes something may go anywhere from there, as fast as it came"),),
    ),
    Mutation(
        "falls-over",
        "what stands on level ground does not fall over",
        "server/aura/adaptive/aura_size.cpp",
        "  if (drop_m >= falls_m) return falls_m;\n",
        "  if (drop_m >= 0) return 0;\n",
        ((AURA, "what lies on level ground sinks no further*"),),
    ),
    Mutation(
        "settled-insists",
        "a request waits although its asker, too, has changed as often as it should",
        "server/aura/adaptive/contests.cpp",
        "        !meets_settled(cluster, asker))\n",
        "        true)\n",
        ((AURA, "a request by a server whose side has changed twice as well is met at once"),),
    ),
    Mutation(
        "far-word",
        "who is far away is expected to say a word in every step",
        "server/region/tolerances.cpp",
        "flight_ticks_ + link.word_every_ticks - 1",
        "flight_ticks_",
        ((REGION, "servers that are far apart do not miss the words that they do not say"),),
    ),
]
