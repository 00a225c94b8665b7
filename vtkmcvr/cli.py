"""Command line: `vtkmcvr demo | render | view | cost | replay | info | presets | warmup`."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence

from . import __version__
from .commands.cost import add_cost
from .commands.info import add_info
from .commands.presets import add_presets
from .commands.render import add_demo, add_render
from .commands.replay import add_replay
from .commands.view import add_view
from .commands.warmup import add_warmup
from .gpu.errors import CudaError

# As shells count ends by signals
BAD_USAGE, INTERRUPTED, UNREAD = 2, 130, 141


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; returns the exit status. Errors are one sentence on stderr."""
    args = _parser().parse_args(arguments)
    try:
        status = args.command(args)
        sys.stdout.flush()
        return status
    except BrokenPipeError:
        # `vtkmcvr info ct/ | head`: the reader has seen enough. What is still buffered goes nowhere
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return UNREAD
    except (ValueError, TypeError, OSError, ImportError, MemoryError, CudaError) as error:
        print(f"vtkmcvr: {_sentence(error)}", file=sys.stderr)
        return BAD_USAGE
    except KeyboardInterrupt:
        print("vtkmcvr: interrupted before there was a picture", file=sys.stderr)
        return INTERRUPTED


def _sentence(error: BaseException) -> str:
    text = " ".join(str(error).split())
    if isinstance(error, MemoryError):
        return f"not enough memory: {text or 'the volume or the film is too large'}"
    return text or type(error).__name__


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="vtkmcvr", description="Physically based Monte Carlo volume rendering."
    )
    parser.add_argument("--version", action="version", version=f"vtkmcvr {__version__}")
    commands = parser.add_subparsers(required=True, metavar="command")
    for add in (
        add_demo, add_render, add_view, add_replay, add_cost, add_info, add_presets, add_warmup,
    ):  # fmt: skip
        add(commands)
    return parser


if __name__ == "__main__":
    sys.exit(main())
