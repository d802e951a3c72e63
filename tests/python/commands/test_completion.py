"""`quadgraph completion`: scripts made from the parsers, and what bash completes with one."""

from __future__ import annotations

import shutil
import subprocess

import pytest

from quadgraph import cli

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")


def script(shell: str, capsys) -> str:
    assert cli.main(["completion", shell]) == 0
    return capsys.readouterr().out


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_a_script_knows_all_commands_and_options(shell, capsys):
    text = script(shell, capsys)
    for name in cli.SUBCOMMANDS:
        assert name in text
    for option in _core.scene_options():
        if option.on_command_line:
            assert option.name in text
    assert all(choice in text for choice in ("quadgraph-fv", "tetgen"))


@pytest.mark.skipif(shutil.which("bash") is None, reason="not installed: bash")
@pytest.mark.parametrize(
    ("words", "completed"),
    [
        (["quadgraph", "tu"], ["turntable"]),
        (["quadgraph", "render", "--mat"], ["--material", "--material-of"]),
        (["quadgraph", "render", "--method", "quadgraph-"], ["quadgraph-fv", "quadgraph-fdm"]),
        (["quadgraph", "turntable", "--turn", "bo"], ["body"]),
        (["quadgraph", "completion", "z"], ["zsh"]),
        (["quadgraph", "info", "bod"], ["body.qgraph"]),
    ],
)
def test_bash_completes(words, completed, tmp_path, capsys):
    (tmp_path / "script").write_text(script("bash", capsys))
    (tmp_path / "body.qgraph").touch()
    quoted = " ".join(f"'{word}'" for word in words)
    asked = (
        f"source ./script; COMP_WORDS=({quoted}); COMP_CWORD={len(words) - 1}; "
        "$(complete -p quadgraph | sed 's/.*-F \\([^ ]*\\).*/\\1/'); printf '%s\\n' \"${COMPREPLY[@]}\""
    )
    done = subprocess.run(["bash", "-c", asked], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.stderr == ""
    assert sorted(word.strip() for word in done.stdout.split()) == sorted(completed)


def test_another_shell_is_wrong_usage(capsys):
    with pytest.raises(SystemExit) as stop:
        cli.main(["completion", "cmd"])
    assert stop.value.code == 2
    assert "choose from 'bash', 'zsh', 'fish'" in capsys.readouterr().err
