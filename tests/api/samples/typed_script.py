"""A user's script that type checkers read."""

import asyncio
from pathlib import Path

import btlang
from btlang import Length, Outcome, Person, Run, Session, Status, action, condition, leaf, parallel, repeat, sequence


@action("cheer for {name} [{times} times]")
def cheer(name: Person, times: int = 1) -> None:
    print(name.upper(), times + 1)


@condition("the path is free for {far}")
def is_free(far: Length) -> bool:
    return far > 0.5


@action
def hop(times: int) -> None:
    print(times + 1)


@condition
def bored() -> bool:
    return True


def steps() -> list[Status]:
    with Session(keywords=[cheer, "words.toml"], world=Path("world.toml")) as session:
        run: Run = session.prepare("cheer for Alice", speed="max", rate=20)
        found: list[Status] = []
        while run.outcome is None:
            found.append(run.tick(0.05))
        return found


async def follow(session: Session) -> float:
    run = session.prepare(sequence("wave", leaf(cheer, "Bob", times=2)))
    async for event in run:
        print(event.t)
    outcome: Outcome = await run
    return outcome.seconds


def tree() -> str:
    return sequence(
        is_free, bored, leaf(hop, 2), repeat(parallel("wave", "nod", success_count=1), num_cycles=2), name="greet"
    ).to("xml")


def written(mission: btlang.Mission, target: str) -> list[str | bytes]:
    again = btlang.parse_tree(mission.to("english"))
    picture: bytes = again.to("png")
    return [picture, mission.to(target)]


def result() -> bool:
    outcome = btlang.parse_tree("wave", keywords=[cheer]).run(time_limit=3)
    print(outcome, outcome.failure, [str(error) for error in outcome.exceptions])
    return outcome.succeeded


if __name__ == "__main__":
    asyncio.run(follow(Session()))
