"""The planted bugs still fit the source, so that tools/planted.py can show that each is detected.

pytest tools/tests/test_planted.py
"""

import shutil

from planted import command as planted


def test_every_patch_applies_to_the_source_as_it_is(capsys):
    assert planted.main(["--check"]) == 0, capsys.readouterr().out


def test_a_patch_that_does_not_apply_is_named(tmp_path, monkeypatch, capsys):
    shutil.copytree(planted.PATCHES, tmp_path, dirs_exist_ok=True)
    patch = tmp_path / "schlick.patch"
    patch.write_text(patch.read_text().replace("reflected_s", "nothing"))
    monkeypatch.setattr(planted, "PATCHES", tmp_path)
    assert planted.main(["--check"]) == 1
    assert "schlick: error: patch failed" in capsys.readouterr().out


def test_every_bug_names_a_test_that_exists():
    for bug in planted.BUGS.values():
        if bug.test:
            file, name = bug.test
            folder = planted.render.ROOT / "tests"
            texts = [path.read_text() for path in [folder / f"{file}.rs", *(folder / file).rglob("*.rs")]]
            assert any(f"fn {name}()" in text for text in texts)
