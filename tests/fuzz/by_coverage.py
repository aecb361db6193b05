"""Fuzzing led by coverage (atheris, the extra `fuzz`): what reaches new lines of loader, checker, scripts, formatter or protocol is changed on.

    python -m tests.fuzz.by_coverage missions -max_total_time=60
    python -m tests.fuzz.by_coverage scripts out/fuzz/scripts -max_total_time=60

What follows the target is libFuzzer's. A text that breaks a promise is written to `crash-…` in the working folder: make it small and keep it
in tests/fuzz/found, where a test reads it for ever.
"""

from __future__ import annotations

import logging
import sys
import tempfile
from pathlib import Path

import atheris

with atheris.instrument_imports(include=["pluto_bt.trees", "pluto_bt.source", "pluto_bt.gateway"]):
    from tests.fuzz import test_fuzz_missions, test_fuzz_protocol, test_fuzz_script

SECONDS_OF_ONE = 10
PROMISES = {
    "missions": lambda data: test_fuzz_missions.survives(test_fuzz_missions.as_document(text_of(data))),
    "scripts": lambda data: test_fuzz_script.survives(text_of(data)),
    "protocol": test_fuzz_protocol.survives,
}
SEEDS = {"missions": test_fuzz_missions.CORPUS, "scripts": test_fuzz_script.CORPUS, "protocol": [b"".join(test_fuzz_protocol.PIECES[10:])]}
WORDS = {
    "missions": [*test_fuzz_missions.PIECES, *test_fuzz_missions.VALUES, *test_fuzz_missions.TAGS], "scripts": test_fuzz_script.PIECES,
    "protocol": test_fuzz_protocol.PIECES,
}  # fmt: skip


def main(argv: list[str]) -> None:
    """Fuzz one target until libFuzzer's time is over."""
    if len(argv) < 2 or argv[1] not in PROMISES:
        sys.exit(f"python -m tests.fuzz.by_coverage {'|'.join(PROMISES)} [FOLDER] [-max_total_time=S]")
    name, more = argv[1], argv[2:]
    logging.disable(logging.CRITICAL)
    with tempfile.TemporaryDirectory() as folder:
        seeds, words = Path(folder, "seeds"), Path(folder, "words")
        seeds.mkdir()
        for number, text in enumerate(SEEDS[name]):
            (seeds / str(number)).write_bytes(bytes_of(text))
        words.write_text("".join(f'"{escaped(word)}"\n' for word in WORDS[name] if word), encoding="ascii")
        kept = [] if any(not word.startswith("-") for word in more) else [folder]  # libFuzzer writes into the first folder
        atheris.Setup([argv[0], *kept, *more, str(seeds), f"-dict={words}", f"-timeout={SECONDS_OF_ONE}"], PROMISES[name])
        atheris.Fuzz()


def text_of(data: bytes) -> str:
    """A text; bytes that are none are read as far as they go."""
    return data.decode("utf-8", "replace")


def bytes_of(word: str | bytes) -> bytes:
    """A text as bytes."""
    return word if isinstance(word, bytes) else word.encode("utf-8", "surrogatepass")


def escaped(word: str | bytes) -> str:
    """A word as libFuzzer's dictionaries have it."""
    return "".join(chr(byte) if 32 <= byte < 127 and chr(byte) not in '"\\' else f"\\x{byte:02X}" for byte in bytes_of(word))


if __name__ == "__main__":
    main(sys.argv)
