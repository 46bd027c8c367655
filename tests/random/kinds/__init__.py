"""Kinds of cases: each a function from dice to a case."""

from kinds import blur, bsdf, function, generated, instance, mesh, oconv, rpict, rtrace, sampled, scene, xform

MODULES = (blur, bsdf, function, generated, instance, mesh, oconv, rpict, rtrace, sampled, scene, xform)
KINDS = {module.__name__.split(".")[-1]: module.make for module in MODULES}
