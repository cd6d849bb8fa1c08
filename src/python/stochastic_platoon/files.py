"""Files that are complete or do not exist."""

from __future__ import annotations

import os
from typing import Iterable, List, Mapping, Union


def write_all(contents: Mapping[str, Union[bytes, Iterable[bytes]]], *, replace: bool = False) -> None:
    """Writes files from their contents or the pieces of these, all or none: under temporary names until they are complete. An error, as of
    a full disk, leaves no part of a file behind.

    Raises OSError with the name of the file that cannot be written: FileExistsError if it exists, unless `replace`.
    """
    temporary = {path: "{}.{}.tmp".format(path, os.getpid()) for path in contents}
    named: List[str] = []
    try:
        for path, content in contents.items():
            with open(temporary[path], "wb") as file:
                for piece in [content] if isinstance(content, bytes) else content:
                    file.write(piece)
                file.flush()
                os.fsync(file.fileno())  # some disks report only now that they are full
        for path in contents:
            if replace:
                os.replace(temporary[path], path)
            else:
                _name(temporary[path], path)
                named.append(path)
    except BaseException as error:
        for done in named:
            os.remove(done)
        if isinstance(error, OSError) and error.errno is not None:
            raise type(error)("{}: cannot be written: {}".format(path, error.strerror)) from None
        raise
    finally:
        for name in temporary.values():
            if os.path.exists(name):
                os.remove(name)


def _name(temporary: str, path: str) -> None:
    """Gives a file its name, unless that exists: a rename would overwrite."""
    try:
        os.link(temporary, path)
    except FileExistsError:
        raise
    except OSError:  # a file system without links, as that of a memory stick
        open(path, "xb").close()
        os.replace(temporary, path)
