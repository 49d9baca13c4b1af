"""What the scripts that write reports share: tables in Markdown, figures as files, the machine in one line."""
import os
import platform

from matplotlib import pyplot


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    lines += ["| " + " | ".join(str(c) for c in row) + " |" for row in rows]
    return "\n".join(lines) + "\n\n"


def save(figure, folder, name):
    figure.tight_layout()
    figure.savefig(folder / f"{name}.png", dpi=110)
    figure.savefig(folder / f"{name}.svg", metadata={"Date": None})
    pyplot.close(figure)


def measured_line(folder):
    """With which commit and build the results in `folder` were measured: what scripts/measured.sh has left there."""
    return (folder / "measured.txt").read_text().strip()


def machine_line():
    model = platform.machine()
    try:
        with open("/proc/cpuinfo") as info:
            model = next((line.split(":", 1)[1].strip() for line in info if line.startswith("model name")), model)
    except OSError:
        pass
    return f"{os.cpu_count()} cores, {model}, Linux {platform.release()}"
