#!/usr/bin/env python3
"""Measures how plain the prose of this repository is, and checks it against limits.

  tools/prose.py [--check] [--worst N] PATH...
  tools/prose.py --subjects

Prose is the text of Markdown files (paragraphs, and table cells of six words or more) and of comments in Rust, TypeScript and
Python. Per kind it prints: sentences; words per sentence; the share of sentences that begin with What, Who, Whose ...; the share
that contain such a word; the share with three or more relative clauses. `--worst N` lists the N sentences with the highest
scores. `--check` exits with 1 if a limit is exceeded, if a test name is longer than 60 characters or if a function name begins
with `what_` or `who_`.

`--subjects` exits with 1 if the subject of a commit after FIRST_SUBJECTS is not `area: imperative` of at most 72 characters. In a
shallow clone it checks the commits that are there.

Low figures are necessary for plain prose, but not sufficient: the program counts words, it does not understand them.
"""
import argparse
import os
import re
import subprocess
import sys

SKIPPED_FOLDERS = {".git", "node_modules", "pictures", "target"}
BEGINS = re.compile(r"^(What|Who|Whoever|Whatever|Whom|Whose|Whichever)\b")
NOUN_CLAUSE = re.compile(r"\b(what|who|whom|whose|whoever|whatever)\b")
RELATIVE = re.compile(r"\b(that|which|what|who|whom|where|whose)\b")
FUNCTION = re.compile(r"(#\[(?:tokio::)?test\][^{}]*?)?\bfn (\w+)")
LONGEST_TEST_NAME = 60

# The subjects of later commits are checked.
FIRST_SUBJECTS = "fcb995202a2e3cacebd5dd350133a519c74abf5f"
SUBJECT = re.compile(r"^[a-z0-9][\w.-]*(, [a-z0-9][\w.-]*)*: [a-z][^.]*([.]\S[^.]*)*$")
LONGEST_SUBJECT = 72
# Endings of verbs that are not imperative: "adds", "added", "adding"; and verbs that end so by themselves.
NO_IMPERATIVE = re.compile(r"(?<![su])s$|ed$|ing$")
IMPERATIVES = {"bring", "embed", "feed", "need", "speed", "swing"}

# Limits per kind: words per sentence; then percent of sentences that begin with, contain and nest.
LIMITS = {"documents": (16.0, 0.3, 2.0, 0.5), "comments": (16.0, 0.5, 2.0, 0.5)}
FIGURES = ("words per sentence", "% begin with what/who", "% contain one", "% nest three relative clauses")


def prose_of_markdown(text):
    text = re.sub(r"```.*?```|<!--.*?-->", "", text, flags=re.S)
    for line in text.splitlines():
        bare = line.strip()
        if bare.startswith("|"):
            yield from (cell.strip() + ".\n" for cell in bare.strip("|").split("|") if len(cell.split()) >= 6)
        elif not bare.startswith(("#", "![")):
            yield line


def prose_of_code(text, marker):
    fenced = False
    for line in text.splitlines():
        comment = re.match(r"\s*" + marker + r" ?(.*)", line)
        if not comment:
            fenced = False
            yield ""
        elif comment[1].startswith("```"):
            fenced = not fenced
        elif not fenced:
            yield comment[1]


def sentences(lines):
    text = "\n".join(lines)
    text = re.sub(r"`[^`]*`", "X", text)
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text)
    text = re.sub(r"[*_]+", "", text)
    for paragraph in re.split(r"\n\s*\n|\n\s*[-*] ", text):
        for sentence in re.split(r"(?<=[.!?:;])\s+(?=[A-Z(])", " ".join(paragraph.split())):
            if len(sentence.split()) >= 4:
                yield sentence


def read(path):
    """Returns the kind of the file's prose and its sentences, or `None` for other files."""
    with open(path, errors="replace") as file:
        text = file.read()
    if path.endswith(".md"):
        return "documents", list(sentences(prose_of_markdown(text)))
    if path.endswith((".rs", ".ts")):
        return "comments", list(sentences(prose_of_code(text, r"//[/!]?")))
    return "comments", list(sentences(prose_of_code(text, r"#")))


def files_below(root):
    if os.path.isfile(root):
        yield root
        return
    for folder, folders, files in os.walk(root):
        folders[:] = sorted(name for name in folders if name not in SKIPPED_FOLDERS and not name.startswith("target"))
        yield from (os.path.join(folder, name) for name in sorted(files))


def score(sentence):
    clauses = 2 * len(NOUN_CLAUSE.findall(sentence)) + len(RELATIVE.findall(sentence))
    return 3 * bool(BEGINS.match(sentence)) + clauses + len(sentence.split()) / 15


def figures(all_sentences):
    count = len(all_sentences) or 1
    share = lambda test: 100 * sum(map(bool, map(test, all_sentences))) / count
    return (
        sum(len(sentence.split()) for sentence in all_sentences) / count,
        share(lambda s: BEGINS.match(s) and not s.endswith("?")),
        share(NOUN_CLAUSE.search),
        share(lambda s: len(RELATIVE.findall(s)) >= 3),
    )


def bad_names(path):
    """Returns complaints about the names of functions and tests in a Rust file."""
    with open(path, errors="replace") as file:
        text = file.read()
    for is_test, name in FUNCTION.findall(text):
        if re.match("(what|who|whose|whom|whoever)_", name):
            yield f"{path}: `{name}` begins with a question word"
        if is_test and len(name) > LONGEST_TEST_NAME:
            yield f"{path}: test name `{name}` has {len(name)} characters, allowed {LONGEST_TEST_NAME}"


def git(*arguments):
    return subprocess.run(["git", *arguments], capture_output=True, text=True)


def subject_complaint(subject):
    """Returns the fault of a commit subject, or `None`."""
    verb = subject.partition(": ")[2].partition(" ")[0]
    if len(subject) > LONGEST_SUBJECT:
        return f"has {len(subject)} characters, allowed {LONGEST_SUBJECT}"
    if not SUBJECT.match(subject) or NO_IMPERATIVE.search(verb) and verb not in IMPERATIVES:
        return "is not `area: imperative`, for example `report: add the name of the bottleneck`"
    return None


def check_subjects():
    commits = "HEAD"
    if git("cat-file", "-e", FIRST_SUBJECTS).returncode == 0:
        commits = FIRST_SUBJECTS + "..HEAD"
    elif git("rev-parse", "--is-shallow-repository").stdout.strip() != "true":
        print(f"subjects: not checked, because commit {FIRST_SUBJECTS[:8]} is not in this repository")
        return
    lines = git("log", "--no-merges", "--format=%h %s", commits).stdout.splitlines()
    pairs = [line.split(" ", 1) for line in lines]
    complaints = [f"{commit}: subject `{s}` {fault}" for commit, s in pairs if (fault := subject_complaint(s))]
    print("\n".join([f"subjects: {len(lines)} commits, {len(complaints)} complaints", *complaints]))
    sys.exit(bool(complaints))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true", help="exit with 1 if a limit is exceeded")
    parser.add_argument("--worst", type=int, default=0, metavar="N", help="list the N sentences with the highest scores")
    parser.add_argument("--subjects", action="store_true", help="check the subjects of commits, and nothing else")
    parser.add_argument("paths", nargs="*", metavar="PATH")
    options = parser.parse_args()
    if options.subjects:
        check_subjects()
        return
    if not options.paths:
        parser.error("expected a file or a folder")

    found = {kind: [] for kind in LIMITS}
    complaints = []
    for path in (path for root in options.paths for path in files_below(root)):
        if path.endswith((".md", ".rs", ".ts", ".py")):
            kind, of_file = read(path)
            found[kind] += [(sentence, path) for sentence in of_file]
        if path.endswith(".rs"):
            complaints += bad_names(path)
    for kind, entries in found.items():
        measured = figures([sentence for sentence, _ in entries])
        print(f"{kind}: {len(entries)} sentences, " + ", ".join(f"{m:.1f} {name}" for m, name in zip(measured, FIGURES)))
        for name, m, limit in zip(FIGURES, measured, LIMITS[kind]):
            if round(m, 1) > limit:
                complaints.append(f"{kind}: {m:.1f} {name}, allowed {limit}")
        for sentence, path in sorted(entries, key=lambda entry: -score(entry[0]))[: options.worst]:
            print(f"    {path}: {sentence}")
    if options.check:
        print("\n".join(complaints), end="\n" if complaints else "")
        sys.exit(bool(complaints))


main()
