#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The graph of a large farm, carried out on paper: how long, and what holds it up?

Each drive is checked and mapped, a date joins its drives and the date before, changes compare it with
the date before, as config/farm/Snakefile says. One engine sends a step at a time, which costs it
--send-s; a free core takes the step that was sent first. What a step costs comes from the command line
(orchard farm status prints what maps cost, farm_costs.sh what the engine does). No randomness.

usage: tests/experiments/farm_scale.py [--logs 10000] [--cores 1000] [--dates 12] [--robots 2]
         [--km 4] [--trees 5000] [--send-s 0.1] [--map-s-per-km 2.0] [--together 1]
"""
import argparse
import heapq


def simulate(args, cores, send_s):
    """Seconds until all is made, core seconds of steps, the longest chain's, number of sendings."""
    blocks = max(1, round(args.logs / (args.dates * args.robots)))
    cost = {
        "check": 0.2 + 0.02 * args.km,
        "map": 0.24 + args.map_s_per_km * args.km,
        "date": 0.3 + args.join_s_per_tree * args.trees * args.robots,
        "changes": 0.3 + args.join_s_per_tree * args.trees,
        "report": 0.5 + args.join_s_per_tree * args.trees,
    }
    kinds, needs = [], []

    def add(kind, *after):
        kinds.append(kind)
        needs.append([a for a in after if a is not None])
        return len(kinds) - 1

    for _ in range(blocks):
        before = None
        for _ in range(args.dates):
            maps = [add("map", add("check")) for _ in range(args.robots)]
            date = add("date", before, *maps)
            add("report", date)
            if before is not None:
                add("changes", date)
            before = date
    waits = [len(n) for n in needs]
    follow = [[] for _ in kinds]
    for step, after in enumerate(needs):
        for a in after:
            follow[a].append(step)
    ready = [step for step, n in enumerate(waits) if n == 0]
    heapq.heapify(ready)
    free, running, now, engine_at, busy, sent = cores, [], 0.0, 0.0, 0.0, 0
    batch = max(1, args.together)
    chain = [0.0] * len(kinds)
    longest = 0.0
    while ready or running:
        while ready and free > 0 and engine_at <= now:
            engine_at = now + send_s
            sent += 1
            for _ in range(min(batch, len(ready), free)):
                step = heapq.heappop(ready)
                free -= 1
                busy += cost[kinds[step]]
                heapq.heappush(running, (engine_at + cost[kinds[step]], step))
        following = []
        if running:
            following.append(running[0][0])
        if ready and free > 0:
            following.append(engine_at)
        now = max(now, min(following))
        while running and running[0][0] <= now:
            _, step = heapq.heappop(running)
            free += 1
            chain[step] = cost[kinds[step]] + max((chain[a] for a in needs[step]), default=0.0)
            longest = max(longest, chain[step])
            for then in follow[step]:
                waits[then] -= 1
                if waits[then] == 0:
                    heapq.heappush(ready, then)
    return now, busy, longest, sent


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--logs", type=int, default=10000)
    parser.add_argument("--cores", type=int, default=1000)
    parser.add_argument("--dates", type=int, default=12)
    parser.add_argument("--robots", type=int, default=2)
    parser.add_argument("--km", type=float, default=4.0)
    parser.add_argument("--trees", type=int, default=5000)
    parser.add_argument("--send-s", type=float, default=0.1)
    parser.add_argument("--map-s-per-km", type=float, default=2.0)
    parser.add_argument("--join-s-per-tree", type=float, default=2e-4)
    parser.add_argument("--together", type=int, default=1, help="steps that are sent at once")
    args = parser.parse_args()
    for cores in sorted({1, max(1, args.cores // 10), args.cores}):
        took, busy, longest, sent = simulate(args, cores, args.send_s)
        limits = {
            "the cores": busy / cores,
            "the engine, which sends one step at a time": sent * args.send_s,
            "the dates of a block, one after the other": longest,
        }
        name = max(limits, key=limits.get)
        print(
            "%5d cores: %8.0f s; %.0f core seconds of steps, %3.0f %% of the cores busy; held up by %s"
            " (at least %.0f s; cores %.0f, engine %.0f, chain %.0f)"
            % (cores, took, busy, 100 * busy / (took * cores), name, limits[name], *limits.values())
        )


if __name__ == "__main__":
    main()
