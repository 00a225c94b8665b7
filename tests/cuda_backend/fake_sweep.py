"""A device that sweeps nothing: it keeps what was asked of it, and gives a film made before."""

from vtkmcvr.gpu.errors import OutOfDeviceMemory


class FakeSweepDevice:
    """Gives `film` and `work` once all blocks are swept; breaks at launch `fail_at`."""

    name = "fake device, compute capability 0.0"

    def __init__(self, film=None, work=(3, 2), room=True, fail_at=None, error=None):
        self.film, self.work, self.room = film, work, room
        self.fail_at, self.error = fail_at, error
        self.swept, self.compiled, self.in_flight, self.most_in_flight = [], 0, 0, 0

    def room_for(self, *parts):
        if not self.room:
            raise OutOfDeviceMemory("scene and film take 9 MiB, fake device has 1 MiB free")

    def upload(self, tables):
        self.tables = tables
        return tables

    def compile(self, tables):
        assert tables is self.tables
        self.compiled += 1

    def sweep(self, tables, first, last):
        if len(self.swept) == self.fail_at:
            raise self.error
        self.swept.append((first, last))
        self.in_flight += 1
        self.most_in_flight = max(self.most_in_flight, self.in_flight)
        return len(self.swept)

    def finished(self, ticket):
        self.in_flight -= 1
        return True

    def download(self, part):
        assert self.in_flight == 0
        return self.film if part is self.tables.film else self.work
