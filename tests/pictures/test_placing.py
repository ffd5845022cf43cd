"""Labels find free spots."""

from __future__ import annotations

from btlang.pictures.world_map import Area, Placer, along


def test_labels_of_one_point_do_not_overlap() -> None:
    placer = Placer(Area(0, 0, 400, 400))
    areas = [placer.place(200, 200, 40, 12, 5)[0] for _ in range(12)]
    assert all(a.overlap(b) == 0 for i, a in enumerate(areas) for b in areas[i + 1 :])


def test_labels_stay_on_the_sheet_and_off_lines() -> None:
    placer = Placer(Area(0, 0, 100, 100))
    placer.avoid(along([(90, 0), (90, 100)], 2.0))
    area, overlap = placer.place(95, 50, 30, 10, 3)
    assert overlap == 0
    assert area.x >= 0
    assert area.x + area.width <= 90


def test_points_along_a_line() -> None:
    assert along([(0, 0), (4, 0), (4, 4)], 3) == [(0, 0), (3, 0), (4, 2), (4, 4)]
    assert along([(1, 1), (1, 1)], 3) == [(1, 1), (1, 1)]
