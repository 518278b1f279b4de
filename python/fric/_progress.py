"""Progress bar of long calls."""

import sys


class Bar:
    """Draws the progress of a call on stderr."""

    def __call__(self, fraction: float) -> None:
        full = int(40 * fraction)
        sys.stderr.write(f"\r[{'#' * full}{'.' * (40 - full)}] {fraction:4.0%}")
        if fraction >= 1:
            self.close()
        sys.stderr.flush()

    def close(self) -> None:
        """Ends the line of the bar."""
        sys.stderr.write("\n")
