"""Faults from outside: kills and interrupts at random moments, full disks, damaged archives,
outputs that take nothing."""

import random
import shutil
import signal

from . import checker, comparison, judge, scenes

KINDS = ("kill",) * 6 + ("interrupt", "terminate", "full disk", "damage", "damage", "output")
"""How often each kind is drawn; all of them come within the first twelve."""

LINE = {"scene_points": 64, "scene_period": 15, "scene_normal_maugis": 2}
SCENES = ({**LINE, "scene_height": "inf", "load_start": "normal_displacement=-1",
           "load_path": "normal_displacement=1; normal_displacement=-4"},
          {**LINE, "scene_height": 50, "scene_poisson": 0.3, "scene_residual_friction": 0.3,
           "load_path": "normal_displacement=1; normal_force=hold; tangential_displacement=20"},
          {**LINE, "scene_height": "inf", "scene_residual_friction": 0.5,
           "load_path": "normal_force=1; tangential_displacement=4; tangential_displacement=0"},
          {**LINE, "scene_height": "inf", "continuation_type": "arclength",
           "continuation_at_fold": "trace", "load_path": "normal_displacement=-3"},
          {**LINE, "scene_dimension": 2, "scene_points": 16, "scene_period": 8,
           "scene_geometry": "sphere", "scene_height": "inf",
           "load_path": "normal_displacement=1; normal_displacement=-3"},)
"""Scenes with legs, a switch of control, jumps, gross sliding, arc length, and a plane."""


def judged(seed, number, worker, folder, seconds):
    """(`judge.Verdict`, command line) of one fault."""
    draw = random.Random(f"{seed} kill {number}")
    kind, options = KINDS[number % len(KINDS)], draw.choice(SCENES)
    scene = scenes.Scene(seed, number, dict(options), given=False)
    trial = Trial(worker, folder, seconds, scene, draw)
    {"kill": lambda: trial.stopped(signal.SIGKILL),
     "interrupt": lambda: trial.stopped(signal.SIGINT),
     "terminate": lambda: trial.stopped(signal.SIGTERM), "full disk": trial.full_disk,
     "damage": trial.damaged, "output": trial.silenced}[kind]()
    return trial.verdict, f"{kind}: {judge.command(['run', *scene.words(folder)])}"


class Trial:
    """One fault on one scene, and its verdict.

    Parameters
    ----------
    worker : judge.Worker
    folder : of archives
    seconds : limit of a run
    scene : scenes.Scene
    draw : random.Random
    """

    def __init__(self, worker, folder, seconds, scene, draw):
        self.worker = worker
        self.folder = folder
        self.seconds = seconds
        self.scene = scene
        self.draw = draw
        self.verdict, self.archive = judge.Verdict(), folder / "stopped.h5"
        self.archive.unlink(missing_ok=True)

    def run(self, name, archive, *flags, **more):
        """Run the scene into an archive; crashes are taken down."""
        words = ["run", *self.scene.words(self.folder, archive_file=archive, archive_fields="all"),
                 *flags]
        return self.told(name, self.worker.run(words, self.folder / name, self.seconds, **more))

    def told(self, name, done):
        """Take down how a command ended, if by a crash or out of time."""
        self.verdict.runs += 1
        self.verdict.seconds += done.seconds
        if "Traceback (most recent call last)" in done.err or done.status in (-6, -7, -8, -11):
            self.verdict.add("crashed", name, done.reason or f"status {done.status}")
        return done

    def whole(self):
        """The story of the run without a fault, and how long it took."""
        path = self.folder / "whole.h5"
        done = self.run("whole", path, "-archive_overwrite")
        return comparison.Story(path), done

    def resumed(self, whole, first):
        """Go on from what is left; it has to end as the whole run did."""
        begun = comparison.Story(self.archive).count if self.archive.exists() else 0
        done = self.run("resumed", self.archive, "-archive_resume")
        if done.status != first.status:
            self.verdict.add("silent" if done.status == 0 else "failed", "resumed",
                             f"status {done.status}: {done.reason}")
            return
        story = comparison.Story(self.archive)
        self.verdict.points += story.count
        for complaint in checker.check(self.archive, done.status if done.status == 0 else None):
            self.verdict.add("silent", "resumed",
                             f"{complaint.kind}, point {complaint.point}: {complaint.text}")
        for sentence in comparison.compare(whole, story, finished=done.status == 0):
            self.verdict.add("silent", "resumed", f"after {begun} points: {sentence}")

    def stopped(self, number):
        """A signal at a random moment, once or twice, then the way to the end."""
        whole, first = self.whole()
        for attempt in range(self.draw.randint(1, 2)):
            done = self.run("stopped", self.archive, *(["-archive_resume"] if attempt else []),
                            signal=[int(number), self.draw.random() * first.clock])
            if (number != signal.SIGKILL and done.status not in (first.status, 128 + number)
                and done.status != -number):
                self.verdict.add("silent", "stopped",
                                 f"status {done.status} after {signal.Signals(number).name}")
            self._readable()
        self.resumed(whole, first)

    def _readable(self):
        """What a stopped run leaves behind can be read, or is not there."""
        if self.archive.exists():
            try:
                comparison.Story(self.archive)
            except (OSError, KeyError, IndexError) as error:
                if not (isinstance(error, IndexError) and checker.read(self.archive) is not None):
                    self.verdict.add("silent", "stopped", f"the archive cannot be read: {error}")

    def full_disk(self):
        """No room for the archive beyond some size: status 1, a word on it, nothing lost."""
        whole, first = self.whole()
        size = int((self.folder / "whole.h5").stat().st_size * self.draw.uniform(0.05, 0.95))
        done = self.run("stopped", self.archive, file_size=size)
        if done.status not in (1, 2) or "error: " not in done.err:
            self.verdict.add("silent", "full disk", f"status {done.status}: {done.reason}")
        self._readable()
        self.resumed(whole, first)

    def damaged(self):
        """Bits of an archive are flipped, or its end is cut off: commands that read it say so, or
        read what is whole."""
        self.whole()
        shutil.copy(self.folder / "whole.h5", self.archive)
        content = bytearray(self.archive.read_bytes())
        if self.draw.random() < 0.3:
            del content[self.draw.randrange(len(content)):]
        else:
            for _ in range(self.draw.choice((1, 4, 64))):
                content[self.draw.randrange(min(len(content),
                                                self.draw.choice((512, 4096, len(content)))))] ^= (
                    1 << self.draw.randrange(8))
        self.archive.write_bytes(content)
        for name, words in (("resume", None), ("plot", ["plot", str(self.archive)])):
            copy = self.folder / f"{name}.h5"
            copy.write_bytes(content)
            done = (self.run(name, copy, "-archive_resume") if words is None
                    else self.told(name, self.worker.run(["plot", str(copy)], self.folder / name,
                                                         self.seconds)))
            if done.status not in (0, 1, 2):
                self.verdict.add("time" if done.status == -9 else "crashed", name,
                                 f"status {done.status}")
            elif done.status and "error: " not in done.err:
                self.verdict.add("silent", name, f"status {done.status} without a sentence")

    def silenced(self):
        """A standard output that takes nothing: the run ends, with a status that says so, and the
        archive has its points."""
        whole, first = self.whole()
        self.run("stopped", self.archive, full=True)
        self._readable()
        self.resumed(whole, first)
