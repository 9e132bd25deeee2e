"""Rewrites a scene file of the short form ([lower], [upper], [body], [counter_surface], [surface], [lattice], [mesh])
into the one form of lists ([[body]], [[contact]]). Comments stay with the section below them.

    python long_form.py scene.toml ...      rewrites files in place
"""
import re
import sys
import tomllib

HEADER = re.compile(r"^\[\[?\s*([A-Za-z0-9_.-]+)\s*\]\]?\s*(#.*)?$")


def sections(text):
    """(header name, header line, comment lines above, lines) of the top and of every section."""
    found, above = [["", "", [], []]], []
    for line in text.splitlines():
        match = HEADER.match(line)
        if match:
            found.append([match.group(1), line, above, []])
            above = []
        elif line.startswith("#") and found[-1][0] != "":
            above.append(line)
        elif line.strip() == "" and found[-1][0] != "":
            above.append(line)
        else:
            found[-1][3] += above + [line]
            above = []
    found[-1][3] += above
    return found


def keys(lines):
    """Pairs (key, lines) of a section; lines of comments go with the key below them."""
    out, pending, depth, current = [], [], 0, None
    for line in lines:
        bare = re.sub(r'"[^"]*"', '""', line).split("#")[0]
        if current is not None and depth > 0:
            current[1].append(line)
        elif line.strip() == "" or line.startswith("#"):
            pending.append(line)
            continue
        else:
            current = [line.split("=")[0].strip(), pending + [line]]
            pending = []
            out.append(current)
        depth += sum(bare.count(c) for c in "[{") - sum(bare.count(c) for c in "]}")
    return out, pending


def strip(lines):
    lines = list(lines)
    while lines and not lines[0].strip():
        lines.pop(0)
    while lines and not lines[-1].strip():
        lines.pop()
    return lines


def convert(text):
    table = tomllib.loads(text)
    if isinstance(table.get("body"), list):
        return text
    found = sections(text)
    # Comments below an empty line at the end of the top belong to the first section.
    lines = found[0][3]
    while len(found) > 1 and lines and (lines[-1].startswith("#") or not lines[-1].strip()):
        found[1][2].insert(0, lines.pop())
    top, rest = found[0], found[1:]
    is_mesh, two = "body" in table, "upper" in table
    by = {}
    for section in rest:
        by.setdefault(section[0].split(".")[0], []).append(section)
    pairs, tail = keys(top[3])
    # Tables written inline at the top become sections.
    for name in ("contact", "mesh", "lower", "upper", "counter_surface", "surface", "admissible", "body", "lattice"):
        inline = [pair for pair in pairs if pair[0] == name]
        if inline:
            value = inline[0][1][-1].split("=", 1)[1].strip()
            inner, depth, word, parts = value[1:-1], 0, "", []
            for c in inner:
                depth += (c in "[{") - (c in "]}")
                if c == "," and depth == 0:
                    parts.append(word.strip())
                    word = ""
                else:
                    word += c
            parts.append(word.strip())
            pairs = [pair for pair in pairs if pair[0] != name]
            by.setdefault(name, []).insert(0, [name, f"[{name}]", inline[0][1][:-1], [part for part in parts if part]])
    size = [line for key, lines in pairs if key == "size" for line in lines]
    out = [line for key, lines in pairs if key != "size" for line in lines] + [line for line in tail]
    out = strip(out)

    def emit(header, comments, lines):
        out.append("")
        out.extend(strip(comments))
        out.append(header)
        out.extend(strip(lines))

    def others(name, new):
        for section in by.get(name, []):
            if section[0] == name:
                continue
            head = section[1].replace(name + ".", new + ".", 1)
            emit(head, section[2], section[3])

    def own(name):
        return next((section for section in by.get(name, []) if section[0] == name), [name, "", [], []])

    mesh = own("mesh")[3] or ["bricks = [12, 12, 12]"]
    if not any(key == "bricks" for key, _ in keys(mesh)[0]):
        mesh = ["bricks = [12, 12, 12]"] + mesh
    counter = own("counter_surface")
    if is_mesh:
        emit("[[body]]", own("body")[2], own("body")[3])
        others("body", "body")
        emit("[body.lattice]", own("lattice")[2], own("lattice")[3])
        others("lattice", "body.lattice")
        slave = None
    else:
        lower = own("lower")
        emit("[[body]]", lower[2], ['name = "lower"'] + strip(lower[3]))
        emit("[body.block]", own("mesh")[2], strip(size) + strip(mesh))
        others("lower", "body")
        for name in ("surface", "admissible"):
            emit(f"[body.{name}]", own(name)[2], own(name)[3])
            others(name, f"body.{name}")
        if two:
            upper, tops = own("upper"), []
            pairs, tail = keys(upper[3])
            tops = [line for key, lines in pairs if key == "top" for line in lines]
            height = tops[-1].split("=", 1)[1].split("#")[0].strip()
            kept = [line for key, lines in pairs if key != "top" for line in lines] + tail
            emit("[[body]]", upper[2], ['name = "upper"'] + strip(kept))
            bare = [line for line in strip(size) + strip(mesh) if not line.startswith("#")]
            emit("[body.block]", [], bare + [f'top = {{ form = "plane", height = {height} }}'])
            emit("[body.block.bottom]", counter[2], counter[3])
            others("upper", "body")
    contact = own("contact")
    pairs, tail = keys(contact[3])
    face = next((lines for key, lines in pairs if key == "face"), None)
    comments = face[:-1] if face else []
    name = face[-1].split("=", 1)[1].strip() if face else '"top"'
    body = 'body = "lower", ' if two else ""
    sides = comments + [f"slave = {{ {body}face = {name} }}"]
    if two:
        sides.append('master = { body = "upper", face = "bottom" }')
        if not any(key == "normal" for key, _ in pairs):
            sides.append('normal = "x3"')
    kept = [line for key, lines in pairs if key != "face" for line in lines] + tail
    emit("[[contact]]", contact[2], sides + strip(kept))
    if not two:
        emit("[contact.obstacle]", counter[2], counter[3])
    others("contact", "contact")
    moved = {"contact", "mesh", "lower", "upper", "counter_surface", "surface", "admissible", "body", "lattice"}
    for section in rest:
        if section[0].split(".")[0] in moved:
            continue
        header, lines = section[1], section[3]
        match = re.match(r"case\.(lower|upper|body)(\..*)?$", section[0])
        if match:
            which, inner = match.group(1), match.group(2) or ""
            if inner == "":
                header, lines = "[[case.body]]", ([f'name = "{which}"'] if not (is_mesh) else []) + lines
            else:
                header = header.replace(f"case.{which}.", "case.body.")
        if section[0] == "case":
            lines = [case_line(line, is_mesh) for line in lines]
        emit(header, section[2], lines)
    text = "\n".join(out).rstrip() + "\n"
    tomllib.loads(text)
    return text


def case_line(line, is_mesh):
    match = re.match(r"(lower|upper|body)\s*=\s*\{(.*)\}\s*$", line)
    if not match:
        return line
    name = "" if is_mesh else f' name = "{match.group(1)}",'
    return f"body = [{{{name}{match.group(2)}}}]"


if __name__ == "__main__":
    for path in sys.argv[1:]:
        with open(path, encoding="utf-8") as file:
            text = file.read()
        with open(path, "w", encoding="utf-8") as file:
            file.write(convert(text))
