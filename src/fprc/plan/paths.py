"""Paths of every file of the workflow."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Paths:
    """Files below the folders ``raw`` and ``results``; arguments may be wildcards."""

    raw: str
    results: str

    def below(self, name: str) -> str:
        """Return a file below the results folder."""
        return f"{self.results}/{name}"

    def log(self, name: str) -> str:
        """Return the raw log of an experiment or a run."""
        return f"{self.raw}/{name}.h5"

    def messages(self, name: str) -> str:
        """Return the file of a job's messages."""
        return self.below(f"logs/{name}.log")

    def data(self, experiment: str) -> str:
        """Return the preprocessed log of an experiment."""
        return self.below(f"data/{experiment}.h5")

    def quality(self, experiment: str) -> str:
        """Return the quality record of a raw log."""
        return self.below(f"quality/{experiment}.json")

    def judged(self, experiment: str, model: str) -> dict[str, str]:
        """Return the files of ``fprc.stages.models.judge``, by its arguments, for one log."""
        return {
            "errors": self.below(f"crossval/{experiment}_{model}.json"),
            "fitted": self.below(f"models/{experiment}_{model}.h5"),
            "fits": self.below(f"predictions/{experiment}_{model}_train.h5"),
            "predictions": self.below(f"predictions/{experiment}_{model}_test.h5"),
        }

    def replicate(self, part: str, seed: int | str) -> str:
        """Return the report of a further seed; part: models, grids or control."""
        return self.below(f"replicates/{part}_{seed}.json")
