"""A file that appears whole or not at all, whatever happens to the process or the disk meanwhile.

The content goes to a temporary file in the target's folder, reaches the disk, and takes the target's name by
a rename, which POSIX makes one step. A process that dies leaves its temporary file behind; the next one to
write in the folder removes it. The writer holds a lock on its temporary file, which the kernel drops with the
process, so that a file that is still being written is told from one that is left over.
"""

from __future__ import annotations

import contextlib
import errno
import io
import os
import re
import secrets
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from tethertest.errors import TethertestError

#: temporary files of this module: hidden, the target's name, 16 hex digits
_PARTIAL = re.compile(r"\.(.+)\.[0-9a-f]{16}\.partial")
#: of the target's name, so much goes into the temporary one: a file system takes 255 bytes
_NAME_SHOWN = 100
#: tries to make a temporary file that no other process cleans away before it is locked
_TRIES = 20


class WholeFile(io.FileIO):
    """The temporary file; a failed write is kept in `failure`, and later ones do nothing.

    HDF5 cannot close a file whose disk is full without a fault of its own, so it is never told.
    """

    failure: OSError | None = None

    def write(self, data: Any) -> int:
        """Write all of the data, or keep why not."""
        left = memoryview(data).cast("B")
        size = left.nbytes
        try:
            while left.nbytes and self.failure is None:
                left = left[super().write(left) :]
        except OSError as error:
            self.failure = error
        return size

    def truncate(self, size: int | None = None) -> int:
        """Set the length, or keep why not."""
        try:
            return super().truncate(size) if self.failure is None else size or 0
        except OSError as error:
            self.failure = error
            return size or 0

    def check(self) -> None:
        """Raise the first failure.

        Raises
        ------
        OSError
            A write failed.
        """
        if self.failure is not None:
            raise self.failure


@contextlib.contextmanager
def written_whole(target: Path) -> Iterator[WholeFile]:
    """Open a file for writing that takes its name when the block ends, and leaves no trace when it fails.

    Parameters
    ----------
    target : Path
        The file to be; its folder is made if it does not exist. A symbolic link is followed. Of two
        processes that write the same file the last one to end wins, whole.

    Raises
    ------
    TethertestError
        The file cannot be written; what stood there before is as it was.
    """
    target = target.resolve()
    if os.path.isdir(target):  # noqa: PTH112 - a name too long is told below
        message = "a folder stands where the file belongs"
        raise TethertestError(message, "remove it or name another file with -o", path=target)
    with _told(target):
        target.parent.mkdir(parents=True, exist_ok=True)
        remove_stale(target.parent)
        partial, file = _locked_partial(target)
    try:
        with file:
            try:
                yield file
            except Exception:
                with _told(target):
                    file.check()  # what HDF5 stumbles over after a failed write is not the cause
                raise
            with _told(target):
                file.check()
                os.fsync(file.fileno())
                partial.replace(target)
        with _told(target):
            _sync_folder(target.parent)
    finally:
        with contextlib.suppress(OSError):
            partial.unlink(missing_ok=True)


@contextlib.contextmanager
def _told(target: Path) -> Iterator[None]:
    """Turn what the system refuses into a message for people."""
    try:
        yield
    except OSError as error:
        raise _not_written(target, error) from error


def remove_stale(folder: Path) -> None:
    """Remove temporary files of this module whose process is gone.

    Parameters
    ----------
    folder : Path
        Where to look, without its subfolders. A file that another process holds stays.
    """
    for path in folder.iterdir():
        if not _PARTIAL.fullmatch(path.name) or path.is_symlink():
            continue
        with contextlib.suppress(OSError), path.open("rb") as file:
            if _lock(file.fileno()) and _is_at(file.fileno(), path):
                path.unlink()


def _locked_partial(target: Path) -> tuple[Path, WholeFile]:
    for _ in range(_TRIES):
        partial = target.with_name(f".{target.name[:_NAME_SHOWN]}.{secrets.token_hex(8)}.partial")
        descriptor = os.open(partial, os.O_RDWR | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0), 0o666)
        file = WholeFile(descriptor, "r+b")
        if _lock(descriptor) is not False and _is_at(descriptor, partial):
            return partial, file
        file.close()  # another process took it for a left-over before it was locked
    message = "another process removes every temporary file"
    raise OSError(errno.EBUSY, message)


def _lock(descriptor: int) -> bool | None:
    """Take the lock on a file; False where another process has it, None where there are no locks."""
    try:
        import fcntl
    except ImportError:  # on such a system a file that is open cannot be removed, which serves as well
        return True
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        return None
    return True


def _is_at(descriptor: int, path: Path) -> bool:
    """Return whether a path still names an open file."""
    try:
        return os.path.samestat(os.fstat(descriptor), path.lstat())
    except FileNotFoundError:
        return False


def _sync_folder(folder: Path) -> None:
    """Bring a rename to the disk, where folders can be synchronised."""
    if os.name != "posix":
        return
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    except OSError as error:
        if error.errno != errno.EINVAL:
            raise
    finally:
        os.close(descriptor)


def _not_written(target: Path, error: OSError) -> TethertestError:
    what = (error.strerror or str(error)).lower()
    remedies = {
        errno.ENOSPC: f"free space on the disk of {target.parent}, or name another place with -o",
        errno.EDQUOT: f"free some of your quota on the disk of {target.parent}, or name another with -o",
        errno.EFBIG: "raise the limit on file sizes (ulimit -f), or name a disk without one with -o",
        errno.ENAMETOOLONG: "give a shorter name with -o",
    }
    remedy = remedies.get(
        error.errno or 0, f"mend the permissions of {target.parent}, or name another place with -o"
    )
    message = f"the file cannot be written ({what}); nothing was changed"
    return TethertestError(message, remedy, path=target)
