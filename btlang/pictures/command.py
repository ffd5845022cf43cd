"""What the options for pictures of `btc run` do."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from btlang.pictures.files import check_picture
from btlang.text.output import show
from btlang.tree.node import Node, Tree

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Protocol

    from btlang.run.events import Sink
    from btlang.text.source import Source

    class Mission(Protocol):
        """What a picture needs of a btlang.api.Mission."""

        @property
        def tree(self) -> Tree: ...

        @property
        def world(self) -> str | Source | None: ...

        def label(self, node: Node) -> str: ...

        def is_action(self, node: Node) -> bool: ...


@contextmanager
def pictures_of(mission: Mission, run: str | None, tree: str | None, quiet: bool) -> Iterator[list[Sink]]:
    """Gives the sinks for a run, and draws it to the files (None: no picture) at the end, however it ends, and says so
    unless it is `quiet`.

    Raises MissionError (BT009, BT081), as far as it can before the run.
    """
    for path in (run, tree):
        if path is not None:
            check_picture(path)
    sinks: list[Sink] = []
    written: list[str] = []
    if tree is not None:
        from btlang.pictures.statuses import LastStatuses

        statuses = LastStatuses()
        sinks.append(statuses)
    if run is not None:
        from btlang.pictures.run_picture import RunPicture
        from btlang.pictures.tree_boxes import title_of
        from btlang.robots.worlds.world_file import load_world

        picture = RunPicture(load_world(mission.world), mission.label, mission.is_action, title_of(mission.tree))
        sinks.append(picture)
    try:
        yield sinks
    finally:
        if run is not None:
            picture.save(run)
            written.append(run)
        if tree is not None and statuses.by_path:
            from btlang.pictures.tree_picture import draw_tree

            draw_tree(mission.tree, mission.label, mission.is_action, tree, run=statuses)
            written.append(tree)
        if written and not quiet:
            show(f"Wrote {' and '.join(written)}.")
