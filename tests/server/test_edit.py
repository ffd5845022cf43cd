"""`btc edit`: one user, one file, nobody else."""

from __future__ import annotations

import json
import os
import signal
import stat
import threading
import time
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from websockets.exceptions import InvalidStatus

from btlang.cli import main
from btlang.editing.words import RobotWords
from btlang.server.accounts.accounts import Accounts
from btlang.server.page import editor, local_page
from btlang.server.page.editor import EditorFiles
from tests.server.doors import LocalDoor, Reply, received
from tests.server.test_edit_trees import TREE
from tests.task.layers import LONG

MISSION = 'include "tea.txt"\npour tea then wave\n'


def editor_of(folder: Path, *options: str, **environment: str) -> LocalDoor:
    """`btc edit` for a file of a folder."""
    return LocalDoor(folder, "edit", str(folder / "tour.txt"), *options, **environment)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("e")


@pytest.fixture(scope="module")
def edited(folder: Path) -> Iterator[LocalDoor]:
    write(folder)
    with closing(editor_of(folder, "--no-browser")) as up:
        up.page = up.enter()  # type: ignore[attr-defined]
        yield up


def write(folder: Path) -> None:
    (folder / "tour.txt").write_text(MISSION)
    (folder / "tea.txt").write_text("pour tea is say tea\n")
    (folder / "secret.txt").write_text("root:x\n")


def save(up: Any, text: str, revision: str, name: str = "tour.txt", **headers: str) -> Reply:
    reply: Reply = up.ask("PUT", f"/api/files/{name}", {"text": text, "revision": revision}, **{**up.page, **headers})
    return reply


def opened(up: Any, name: str = "tour.txt") -> Any:
    return up.ask("GET", f"/api/files/{name}", **up.page).data["data"]


def test_the_file_is_read_saved_and_shown_with_what_it_includes(edited: Any, folder: Path) -> None:
    write(folder)
    me = edited.ask("GET", "/api/me", **edited.page).data
    assert (me["user"], me["role"]) == ("you", "administrator")
    listed = edited.ask("GET", "/api/files", **edited.page).data["data"]["files"]
    assert listed == [
        {"name": "tour.txt", "saves": True}, {"name": "tea.txt", "saves": False},
        {"name": "tour.test.txt", "saves": True},
    ]  # fmt: skip
    assert opened(edited, "tea.txt")["text"] == "pour tea is say tea\n"
    now = opened(edited)
    assert now["text"] == MISSION
    shown = edited.ask("POST", "/api/document", {"text": MISSION}, **edited.page).data
    assert [each["label"] for each in shown["nodes"]] == ["then", "pour tea", "wave", "say tea"]
    saved = save(edited, MISSION + "nod\n", now["revision"]).data
    assert saved["ok"]
    assert (folder / "tour.txt").read_text() == MISSION + "nod\n"
    assert opened(edited)["revision"] == saved["data"]["revision"]


def test_two_windows_hear_of_each_other(edited: Any) -> None:
    cookie = edited.page["cookie"]
    place = {"type": "presence", "robot": "", "screen": "write", "mission": "tour.txt", "changing": True}
    with edited.socket(cookie=cookie) as one, edited.socket(cookie=cookie) as other:
        for each in (one, other):
            each.send(json.dumps(place))
        while len(people := received(one, type="people")["people"]) < 2:
            pass
        assert [each["user"] for each in people] == ["you", "you"]


def test_a_stale_save_is_refused_with_the_difference(edited: Any, folder: Path) -> None:
    write(folder)
    before = opened(edited)["revision"]
    (folder / "tour.txt").write_text(MISSION + "dock\n")
    refused = save(edited, MISSION + "nod\n", before)
    assert (refused.status, refused.data["code"]) == (409, "BT187")
    assert "-dock\n+nod" in refused.data["data"]["diff"]
    assert (folder / "tour.txt").read_text() == MISSION + "dock\n"
    assert save(edited, MISSION + "nod\n", refused.data["data"]["revision"]).status == 200
    together = opened(edited)["revision"]
    texts = [f"wave\nsay {number}\n" for number in range(4)]
    replies: list[Reply] = []
    threads = [
        threading.Thread(target=lambda text=text: replies.append(save(edited, text, together))) for text in texts
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(LONG)
    assert sorted(each.status for each in replies) == [200, 409, 409, 409]


def test_a_file_that_vanished_is_made_again_only_if_asked(edited: Any, folder: Path) -> None:
    write(folder)
    before = opened(edited)["revision"]
    (folder / "tour.txt").unlink()
    assert opened(edited) == {"text": "", "revision": ""}
    refused = save(edited, "wave\n", before)
    assert (refused.status, refused.data["data"]["revision"]) == (409, "")
    assert save(edited, "wave\n", "").status == 200
    assert (folder / "tour.txt").read_text() == "wave\n"


def test_files_that_cannot_be_used_have_their_codes(edited: Any, folder: Path) -> None:
    write(folder)
    file = folder / "tour.txt"
    file.write_bytes(b"wave\xff\n")
    for reply in (edited.ask("GET", "/api/files/tour.txt", **edited.page), save(edited, "nod\n", "")):
        assert (reply.status, reply.data["code"]) == (400, "BT002")
    assert file.read_bytes() == b"wave\xff\n"
    file.write_text("x" * 200_001)
    assert edited.ask("GET", "/api/files/tour.txt", **edited.page).data["code"] == "BT001"
    file.unlink()
    file.mkdir()
    assert save(edited, "nod\n", "").data["code"] == "BT001"
    file.rmdir()
    os.mkfifo(file)
    assert edited.ask("GET", "/api/files/tour.txt", **edited.page).data["code"] == "BT001"
    file.unlink()


def test_line_ends_and_modes_stay(edited: Any, folder: Path) -> None:
    file = folder / "tour.txt"
    file.write_bytes(b"\xef\xbb\xbfwave\r\nnod\r\n")
    file.chmod(0o640)
    assert save(edited, "wave\ndock\n", opened(edited)["revision"]).status == 200
    assert file.read_bytes() == b"\xef\xbb\xbfwave\r\ndock\r\n"
    assert stat.S_IMODE(file.stat().st_mode) == 0o640
    assert save(edited, "wave\n", opened(edited)["revision"]).status == 200
    assert [path.name for path in folder.iterdir() if path.suffix == ".new"] == []


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anything")
def test_a_protected_file_is_shown_and_not_saved(edited: Any, folder: Path) -> None:
    write(folder)
    (folder / "tour.txt").chmod(0o400)
    assert opened(edited)["text"] == MISSION
    reply = save(edited, "nod\n", opened(edited)["revision"])
    assert (reply.status, reply.data["code"]) == (400, "BT009")
    (folder / "tour.txt").chmod(0o600)


def test_no_other_file_is_reached(edited: Any, folder: Path) -> None:
    write(folder)
    for name in (
        "secret.txt",
        "../tour.txt",
        "%2e%2e/tour.txt",
        "/etc/passwd",
        str(folder / "secret.txt"),
        "tour.txt%00",
        "",
    ):
        reply = edited.ask("GET", f"/api/files/{name}", **edited.page)
        assert "root:" not in str(reply.body), name
        assert reply.status in (404, 307), name
        assert save(edited, "nod\n", "", name).status in (403, 404, 307), name
    assert save(edited, "nod\n", opened(edited, "tea.txt")["revision"], "tea.txt").status == 403
    (folder / "tour.txt").write_text(f'include "{folder}/../../../etc/passwd"\nwave\n')
    assert len(edited.ask("GET", "/api/files", **edited.page).data["data"]["files"]) == 2


@pytest.mark.parametrize(
    "body",
    [
        {},
        {"text": "nod"},
        {"text": 1, "revision": ""},
        {"text": "a", "revision": None},
        {"text": "\ud800", "revision": ""},
    ],
)
def test_bad_saves_are_refused(edited: Any, folder: Path, body: object) -> None:
    write(folder)
    assert edited.ask("PUT", "/api/files/tour.txt", body, **edited.page).status == 400
    assert (folder / "tour.txt").read_text() == MISSION


def test_nobody_else_comes_in(edited: Any, folder: Path) -> None:
    write(folder)
    page = edited.page
    for path in ("/api/files", "/api/files/tour.txt", "/api/me"):
        assert edited.ask("GET", path).status == 401
        assert edited.ask("GET", path, **{**page, "host": f"evil.example:{edited.port}"}).status == 403
        assert edited.ask("GET", path, **{**page, "host": "127.0.0.1.evil.example"}).status == 403
    for token in (edited.token, "", "x", "\ud800", "x" * 100_000):  # the first one was used
        assert edited.ask("POST", "/api/login", {"token": token}).status == 401
    assert edited.ask("POST", "/api/login", {"name": "you", "password": ""}).status == 400
    assert edited.ask("POST", "/api/login", {"token": edited.token}, origin="http://evil.example").status == 403
    for origin in ("http://evil.example", "http://127.0.0.1:1", f"http://localhost:{edited.port}", "null"):
        assert save(edited, "nod\n", opened(edited)["revision"], origin=origin).status == 403
        with pytest.raises(InvalidStatus):
            edited.socket(cookie=page["cookie"], origin=origin)
    assert save(edited, "nod\n", opened(edited)["revision"], x_csrf_token="").status == 403
    with pytest.raises(InvalidStatus):
        edited.socket(cookie=page["cookie"], host=f"evil.example:{edited.port}")
    assert (folder / "tour.txt").read_text() == MISSION


def test_the_cookie_is_for_this_site_and_its_scripts_cannot_read_it(
    tmp_path_factory: pytest.TempPathFactory,
) -> None:
    folder = tmp_path_factory.mktemp("c")
    with closing(editor_of(folder, "--no-browser")) as up:
        reply = up.ask("POST", "/api/login", {"token": up.token}, origin=f"http://127.0.0.1:{up.port}")
        cookie = reply.headers["set-cookie"].lower()
        assert cookie.startswith(f"btlang-{up.port}=")
        assert all(part in cookie for part in ("httponly", "samesite=strict", "path=/"))
        assert "secure" not in cookie
        up.process.send_signal(signal.SIGINT)
        up.process.wait(LONG)
    assert [path.name for path in folder.iterdir() if path.name.startswith("btlang-")] == []


def test_a_token_is_good_for_a_minute(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from starlette.testclient import TestClient

    words = RobotWords(file=str(tmp_path / "tour.txt"))
    with closing(Accounts(str(tmp_path / "accounts"), clock=lambda: 0.0)) as accounts:
        api = editor.EditorApi(accounts, EditorFiles(words), words, 1)
        client: Any = TestClient(api.app(), base_url="http://127.0.0.1:1")
        later = time.monotonic() + local_page.OPEN + 1
        monkeypatch.setattr(local_page.time, "monotonic", lambda: later)
        late = client.post("/api/login", json={"token": api.ticket})
        assert (late.status_code, "too old" in late.json()["text"]) == (401, True)


@pytest.mark.parametrize(
    ("name", "code"),
    [
        ("nowhere/tour.txt", "BT009"), (".", "BT001"), ("binary.txt", "BT002"), ("long.txt", "BT001"),
        ("nowhere.xml", "BT001"), ("broken.xml", "BT120"), ("two.xml", "BT125"), ("long.xml", "BT001"),
    ],
)  # fmt: skip
def test_what_cannot_be_edited_says_so_at_once(
    name: str, code: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(local_page, "PAGE", Path(__file__))
    (tmp_path / "binary.txt").write_bytes(b"\xff")
    (tmp_path / "long.txt").write_text("x" * 300_000)
    (tmp_path / "broken.xml").write_text("<root><")
    (tmp_path / "two.xml").write_text(
        TREE.replace(' main_tree_to_execute="Main"', "").replace('<SubTree ID="Grab"/>', "")
    )
    (tmp_path / "long.xml").write_text(TREE.replace("<!-- both -->", '<Open door="kitchen"/>' * 9_000))
    assert main(["edit", str(tmp_path / name)]) == 2
    assert f"error {code}: " in capsys.readouterr().err


def test_without_the_page_it_says_how_to_get_it(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(local_page, "PAGE", Path("nowhere"))
    assert main(["edit", "tour.txt"]) == 2
    assert "pip install" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        main(["edit", "-"])


def test_the_tests_beside_it_are_saved_and_run(edited: Any, folder: Path) -> None:
    write(folder)
    ending = "\n  finally the mission succeeds\n"
    tests = f'test "it waves":\n  run "tour.txt"{ending}test "other":\n  run "nod.txt"{ending}'
    (folder / "nod.txt").write_text("nod\n")
    assert opened(edited, "tour.test.txt") == {"text": "", "revision": ""}
    assert save(edited, tests, "", "tour.test.txt").data["ok"]
    assert (folder / "tour.test.txt").read_text() == tests
    assert save(edited, "nod", "", "tour.test.txt").status == 409
    assert save(edited, "nod", "", "other.test.txt").status == 403

    def run(text: str) -> Any:
        asked = {"text": text, "tests": tests, "called": "tour.txt"}
        return edited.ask("POST", "/api/test", asked, **edited.page).data

    assert [each["passed"] for each in run("wave")["results"]] == [True, True]
    failed = run("wave then fail")["results"][0]
    assert (failed["passed"], failed["at"]) == (False, 3)
    assert "wave then fail"[failed["start"] : failed["end"]] == "fail"
    (folder / "nod.txt").write_text("nod\nfail\n")
    other = run("wave")["results"][1]
    assert (other["passed"], other["start"], other["film"]["text"]) == (False, None, "")
    assert run("wavee")["messages"][0]["code"] == "BT010"
