"""Names that differ between FreeCAD 0.20 (PathScripts), 0.21 and 1.x (Path.Main, Path.Post; the workbench is called CAM)."""
import importlib


def first_module(*names):
    """The first of the modules that this FreeCAD has."""
    problem = None
    for name in names:
        try:
            return importlib.import_module(name)
        except ImportError as error:
            problem = error
    raise problem


def preferences():
    return first_module("Path.Preferences", "PathScripts.PathPreferences")


def util():
    return first_module("Path.Base.Util", "PathScripts.PathUtil")


def job_module():
    return first_module("Path.Main.Job", "PathScripts.PathJob")


def is_job(obj):
    return isinstance(getattr(obj, "Proxy", None), job_module().ObjectJob)


def jobs_of(document):
    return [obj for obj in document.Objects if is_job(obj)]


def job_of(obj):
    """The job that an operation, a tool controller or a stock belongs to; the job itself; None."""
    seen = set()
    waiting = [obj]
    while waiting:
        at = waiting.pop()
        if at is None or id(at) in seen or not hasattr(at, "InList"):
            continue
        seen.add(id(at))
        if is_job(at):
            return at
        waiting.extend(at.InList)
    return None


def _legacy_post(name):
    """(module of the post-processor, as FreeCAD up to 0.21 loads it)."""
    processor = first_module("Path.Post.Processor", "PathScripts.PathPostProcessor")
    return processor.PostProcessor.load(name).script


def _factory():
    """FreeCAD 1.0 and later; None in older ones."""
    try:
        return importlib.import_module("Path.Post.Processor").PostProcessorFactory
    except (ImportError, AttributeError):
        return None


def post_list(job):
    """The objects of a job in the order in which they are posted, tool changes and fixtures between them."""
    factory = _factory()
    if factory is not None:
        build = factory.get_post_processor(job, job.PostProcessor)._buildPostList
        return [obj for _, part in build() for obj in part]
    command = first_module("Path.Post.Command", "PathScripts.PathPost")
    build = getattr(command, "buildPostList", None)  # 0.21
    if build is None:
        build = command.CommandPathPost().buildPostList
    return [obj for part in build(job) for obj in part]


class _OtherArguments:
    """A job with other arguments of its post-processor, for a while."""

    def __init__(self, job, name, arguments):
        self.job, self.kept = job, (job.PostProcessor, job.PostProcessorArgs)
        self.given = (name, arguments)

    def __enter__(self):
        self.job.PostProcessor, self.job.PostProcessorArgs = self.given

    def __exit__(self, *_):
        self.job.PostProcessor, self.job.PostProcessorArgs = self.kept


def run_post(name, arguments, job, objects):
    """The text that the post-processor `name` makes of `objects`, posted as one program. Without its editor."""
    factory = _factory()
    if factory is not None:
        with _OtherArguments(job, name, arguments):
            sections = factory.get_post_processor(job, name).export()
        if not sections:
            return None
        return "".join(text for _, text in sections if text)
    script = _legacy_post(name)
    if hasattr(script, "SHOW_EDITOR"):
        script.SHOW_EDITOR = False
    return script.export(objects if objects is not None else post_list(job), "-", arguments)


def post_exists(name):
    return name in preferences().allAvailablePostProcessors()
