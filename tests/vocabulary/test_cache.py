"""The cache of vocabularies: as if it were not there, but for the time."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from btlang.diagnostics.diagnostic import MissionError
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.text.source import Source
from btlang.text.words import split
from btlang.vocabulary import cache
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.load import load_vocabulary
from btlang.vocabulary.trie import longest

HOP = '[[action]]\nphrase = "hop [{length}]"\nid = "Hop"\n'
NAMES = {"place": ["lab"], "person": ["Alice"], "object": ["cup"]}


class _Forgetful(dict[object, object]):
    """As if each reading were in a process of its own."""

    def __setitem__(self, key: object, value: object) -> None:
        """Keeps nothing."""


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of the cache, empty at first."""
    folder = tmp_path / "cache"
    monkeypatch.setattr(cache, "user_dir", lambda kind: str(folder))
    monkeypatch.setattr(cache, "_in_process", _Forgetful())
    return folder


@pytest.fixture
def pack(tmp_path: Path) -> Path:
    """A keyword file."""
    pack = tmp_path / "hops.toml"
    pack.write_text(HOP)
    return pack


def is_read(make: Callable[[], object]) -> bool:
    """Whether keyword files are read for it."""
    import btlang.vocabulary.keyword_file as keyword_file

    reads: list[Source] = []
    read = keyword_file.read_keyword_file
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(keyword_file, "read_keyword_file", lambda source: (reads.append(source), read(source))[1])
        make()
    return bool(reads)


def described(vocabulary: Lexicon) -> list[object]:
    """All that a vocabulary says, as values to compare."""
    said: list[object] = []
    for entries in vocabulary.entries.values():
        for entry in entries:
            for pattern in (entry.example, *entry.phrases):
                text = split(Source(pattern.replace("{", "").replace("}", "")), vocabulary.orthography)
                said += [
                    longest(trie, text, 0, vocabulary.context) for trie in (vocabulary.trie, vocabulary.quantities)
                ]
            said += [entry, entry.span and (entry.span, entry.span.place, entry.span.text)]
    tables = vocabulary.roles, vocabulary.counts, vocabulary.about, vocabulary.comparisons, dict(vocabulary.types)
    return [*said, *tables, vocabulary.articles, vocabulary.word("then"), vocabulary.value("duration", "half an hour")]


def test_the_vocabulary_is_the_same(pack: Path) -> None:
    made, found = (load_vocabulary([str(pack)], NAMES) for _ in range(2))
    assert described(found) == described(made)
    assert found.trie == made.trie
    assert found.entries["Hop"][0].span is not None
    assert found.entries["Hop"][0].span.place == f"{pack}:2:11"
    assert not is_read(lambda: load_vocabulary([str(pack)]))


def test_what_is_added_to_one_is_not_in_the_next() -> None:
    assert load_vocabulary(names={"place": ("moon",)}).value("place", "moon") == "moon"
    assert load_vocabulary().value("place", "moon") is None


def test_a_changed_file_is_read_anew(pack: Path) -> None:
    assert "Hop" in load_vocabulary([str(pack)]).entries
    pack.write_text(HOP.replace("Hop", "Bow"))  # of the same size
    assert "Bow" in load_vocabulary([str(pack)]).entries
    times = pack.stat()
    pack.write_text(HOP)
    os.utime(pack, ns=(times.st_atime_ns, times.st_mtime_ns))
    assert "Hop" in load_vocabulary([str(pack)]).entries
    assert "Hop" not in load_vocabulary().entries


def test_the_names_of_a_changed_world(tmp_path: Path) -> None:
    world = tmp_path / "world.toml"
    for name in ("moon", "mars"):
        world.write_text(f'start = {{ x = 0, y = 0 }}\nplaces = [{{ name = "{name}", x = 1, y = 1 }}]\n')
        for _ in range(2):
            vocabulary = world_vocabulary(world=str(world))
            assert [place for place in ("moon", "mars", "lab") if vocabulary.value("place", place)] == [name]
    world.write_text("places = 5\n")
    for _ in range(2):
        with pytest.raises(MissionError, match="BT070"):
            world_vocabulary(world=str(world))
    with pytest.raises(MissionError, match="BT070"):
        world_vocabulary(world="")


def test_a_wrong_file_is_told_each_time(pack: Path) -> None:
    load_vocabulary([str(pack)])
    pack.write_text(HOP + "foo = 1\n")
    for _ in range(2):
        with pytest.raises(MissionError, match=r"hops\.toml:2:11"):
            load_vocabulary([str(pack)])


def test_changed_code_makes_it_anew(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    package = tmp_path / "package"
    for folder in cache._CODE:
        (package / folder).mkdir(exist_ok=True)
    module = package / "vocabulary" / "pattern.py"
    module.write_text("")
    states = {cache._code(), code_of(package, monkeypatch)}
    assert len(states) == 2
    module.write_text("pass")
    assert code_of(package, monkeypatch) not in states
    monkeypatch.setattr(cache, "_code", lambda: "00000000")
    assert is_read(load_vocabulary)
    assert not is_read(load_vocabulary)
    monkeypatch.setattr(cache, "_code", lambda: "00000001")
    assert is_read(load_vocabulary)


def code_of(package: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """The state of the code of a package as it is now."""
    monkeypatch.setattr(cache, "_PACKAGE", str(package))
    return cache._code.__wrapped__()


@pytest.mark.parametrize(
    "damage",
    [
        lambda data: b"",
        lambda data: data[: len(data) // 2],
        lambda data: data[:-1],
        lambda data: data[:-5000] + bytes([data[-5000] ^ 1]) + data[-4999:],
        lambda data: b"cos\nsystem\n(S'exit 1'\ntR.",
        lambda data: data[:2000] + b"\0" * len(data),
    ],
)
def test_a_damaged_file_is_written_anew(damage: Callable[[bytes], bytes], folder: Path, pack: Path) -> None:
    made: list[list[str]] = []

    def make() -> list[str]:
        made.append([str(number) for number in range(2_000)])
        return made[-1]

    def found() -> list[str]:
        return cache.cached("numbers", [str(pack)], make)

    found()
    [file] = folder.iterdir()
    whole = file.read_bytes()
    file.write_bytes(damage(whole))
    assert found() == made[0]
    assert len(made) == 2
    assert file.read_bytes() == whole
    assert found() == made[0]
    assert len(made) == 2


@pytest.mark.skipif(os.name == "nt", reason="permissions are another matter there")
def test_what_others_can_write_to_is_not_loaded(folder: Path) -> None:
    load_vocabulary()
    [file] = folder.iterdir()
    file.chmod(0o666)
    assert is_read(load_vocabulary)
    assert file.stat().st_mode & 0o777 == 0o600
    folder.chmod(0o777)
    assert is_read(load_vocabulary)
    folder.chmod(0o700)
    assert not is_read(load_vocabulary)


@pytest.mark.skipif(os.name == "nt", reason="files have no such owner there")
def test_what_belongs_to_another_user_is_not_loaded(monkeypatch: pytest.MonkeyPatch) -> None:
    load_vocabulary()
    monkeypatch.setattr(os, "getuid", lambda: os.geteuid() + 1)
    assert is_read(load_vocabulary)


def test_a_folder_that_cannot_be_written(folder: Path) -> None:
    folder.write_text("a file is in the way")
    assert "Wave" in load_vocabulary().entries
    assert is_read(load_vocabulary)


def test_a_user_without_a_home(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(cache, "user_dir", lambda kind: "~/.cache/btlang")
    assert "Wave" in load_vocabulary().entries
    assert not list(tmp_path.iterdir())


def test_the_number_of_files_is_bounded(folder: Path, tmp_path: Path) -> None:
    for number in range(cache.MOST_FILES + 3):
        pack = tmp_path / f"{number}.toml"
        pack.write_text("")
        assert cache.cached("number", [str(pack)], lambda number=number: number) == number
    assert len(list(folder.iterdir())) == cache.MOST_FILES


def test_what_is_used_outlives_what_is_made_once(monkeypatch: pytest.MonkeyPatch, folder: Path, tmp_path: Path) -> None:
    monkeypatch.setattr(cache, "MOST_FILES", 3)
    packs = [tmp_path / f"{number}.toml" for number in range(8)]
    for pack in packs:
        pack.write_text("")
        assert cache.cached("number", [str(pack)], lambda: True)
        assert cache.cached("number", [str(packs[0])], lambda: not packs[1].exists())
        for file in folder.iterdir():
            os.utime(file, ns=(0, file.stat().st_mtime_ns - 1_000_000_000))


def test_many_files_of_users_displace_no_words_that_ship(folder: Path, tmp_path: Path) -> None:
    load_vocabulary()
    for number in range(cache.MOST_FILES + 3):
        pack = tmp_path / f"{number}.toml"
        pack.write_text("")
        for kind in ("words", "file", "world"):
            cache.cached(kind, [str(pack)], lambda: True)
    assert not is_read(load_vocabulary)


def test_writers_at_the_same_time(folder: Path) -> None:
    code = (
        "from btlang.vocabulary import cache\n"
        f"cache.user_dir = lambda kind: {str(folder)!r}\n"
        "made = [str(number) for number in range(100_000)]\n"
        "for _ in range(10):\n"
        "    cache._write(cache.os.path.join(cache.own_folder(), 'words-x'), b'key', made)\n"
        "    assert cache._loaded(cache.os.path.join(cache.own_folder(), 'words-x'), b'key') == made\n"
    )
    processes = [subprocess.Popen([sys.executable, "-c", code]) for _ in range(4)]
    assert [process.wait(60) for process in processes] == [0] * 4
    assert [file.name for file in folder.iterdir()] == ["words-x"]
