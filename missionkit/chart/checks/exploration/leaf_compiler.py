"""Guards compiled as the engine does, but for leaf guards, which something else answers."""

from __future__ import annotations

import abc

from typing_extensions import override

from missionkit.chart.model import guard_expressions as ex
from missionkit.chart.semantics.compiled_chart import AskedGuard, GuardFunction
from missionkit.chart.semantics.guard_compiler import FALSE_VERDICT, GuardCompiler, answered
from missionkit.errors import NO_PLACE
from missionkit.guards.state_progress import Done, Elapsed
from missionkit.plugin import Plugin


class LeafCompiler(GuardCompiler, abc.ABC):
    """Compiles guards; only the time in the state is asked for as in flight."""

    @abc.abstractmethod
    def _leaf(self, name: str, guard: ex.Expression) -> GuardFunction:
        """Return what answers a leaf guard."""

    @override
    def asked(self, expression: ex.Expression, *, unknown_takes: bool = False) -> AskedGuard:
        return AskedGuard(self.ask(expression), unknown_takes)

    @override
    def _plugin(self, name: str, plugin: Plugin) -> GuardFunction:
        if isinstance(plugin, Elapsed):
            return super()._plugin(name, plugin)
        asked = self._leaf(name, ex.Use(str(plugin.kind), plugin, NO_PLACE))
        if not isinstance(plugin, Done):
            return asked
        return answered(
            name, lambda question: asked(question) if question.seen.done else FALSE_VERDICT
        )
