"""Reads series and scalars of a study from a hearsay database into numpy arrays."""

import functools
import os
import sqlite3
import sys
import urllib.parse

import numpy as np

APPLICATION_ID = 0x68727379  # "hrsy"
SCHEMA_VERSION = 2  # that of sim/record/database.hpp
CENTRAL = -1


class UserError(Exception):
    """Something the user can put right; the message says what."""


def main(function):
    """Runs a script's main function. A user's mistake ends with a message and exit code 2."""
    try:
        function()
    except (UserError, sqlite3.Error, OSError) as error:
        print(f"{os.path.basename(sys.argv[0])}: {error}", file=sys.stderr)
        sys.exit(2)


@functools.lru_cache(maxsize=None)
def label_text(label):
    """One spelling for an axis label: `0`, `0.0` and `0.00` are one number."""
    text = str(label).strip().strip('"')
    try:
        return f"{float(text):g}"
    except ValueError:
        return text


def percent(label):
    """A share as a reader says it: 0.1 as 10 %; a label that is no number as it is."""
    try:
        return f"{100.0 * float(label):g} %"
    except ValueError:
        return label


def parse(parser, defaults=None):
    """Arguments that every script takes: DATABASE OUTPUT [--study S] [--AXIS LABEL]…

    Returns (namespace, axis → label). `defaults` are taken for axes that the study has and the user
    did not name."""
    parser.allow_abbrev = False
    parser.usage = "%(prog)s DATABASE OUTPUT [--study S] [--AXIS LABEL]…"
    parser.add_argument("database")
    parser.add_argument("output")
    parser.add_argument("--study", help="needed if the database holds several")
    arguments, rest = parser.parse_known_args()
    where = {}
    while rest:
        name, equals, label = rest[0].partition("=")
        if not name.startswith("--") or (not equals and len(rest) < 2):
            parser.error(f"expected --AXIS LABEL, found {rest[0]!r}")
        where[name[2:]] = label if equals else rest[1]
        rest = rest[1 if equals else 2 :]
    database = Database(arguments.database)
    study = database.study(arguments.study)
    for axis, label in (defaults or {}).items():
        if axis in database.axes(study):
            where.setdefault(axis, label)
    return arguments, database.select(study, where)


def write_whole(file, write):
    """Calls write(temporary name) and renames: `file` is whole or as it was."""
    partial = file + ".partial"
    try:
        write(partial)
        os.replace(partial, file)
    except OSError as error:
        raise UserError(f"{file}: cannot be written ({error.strerror or error})") from error
    finally:
        if os.path.exists(partial):
            os.remove(partial)


def write_text(file, text):
    def write(partial):
        with open(partial, "w", encoding="utf-8", newline="") as stream:
            stream.write(text)

    write_whole(file, write)


class Database:
    """A database, opened read-only."""

    def __init__(self, file):
        if not os.path.isfile(file):
            raise UserError(f"{file}: no such database")
        uri = "file:" + urllib.parse.quote(os.path.abspath(file)) + "?mode=ro"
        self.file = file
        try:
            self._connection = sqlite3.connect(uri, uri=True)
            self._connection.execute("PRAGMA temp_store = memory")
            application = self._one("PRAGMA application_id")
            version = self._one("PRAGMA user_version")
        except sqlite3.Error as error:
            raise UserError(f"{file}: not a database that can be read ({error})") from error
        if application != APPLICATION_ID:
            raise UserError(f"{file}: a database, but not one of hearsay")
        if version != SCHEMA_VERSION:
            raise UserError(
                f"{file}: its schema has version {version}, these scripts read {SCHEMA_VERSION}"
            )

    def _one(self, sql):
        return self._connection.execute(sql).fetchone()[0]

    def rows(self, sql, parameters=()):
        try:
            return self._connection.execute(sql, parameters).fetchall()
        except sqlite3.Error as error:
            raise UserError(f"{self.file}: {error}") from error

    def insert(self, sql, rows):
        self._connection.executemany(sql, rows)

    def study(self, wanted):
        """The study of that name, or the only one there is."""
        names = [row[0] for row in self.rows("SELECT DISTINCT study FROM run ORDER BY study")]
        if wanted is not None and wanted not in names:
            raise UserError(f"{self.file}: no study {wanted!r}; there are: {', '.join(names)}")
        if wanted is None and len(names) != 1:
            found = f"several studies, choose with --study: {', '.join(names)}"
            raise UserError(f"{self.file}: {found if names else 'it holds no runs'}")
        return wanted if wanted is not None else names[0]

    def axes(self, study):
        """Names of the axes of a study, in its order."""
        rows = self.rows(
            "SELECT name FROM axis WHERE run = (SELECT MIN(id) FROM run WHERE study = ?)",
            (study,),
        )
        return [row[0] for row in rows]

    def select(self, study, where):
        """The finished runs of a study whose axes have these labels."""
        axes = {}
        for run, name, value in self.rows(
            "SELECT a.run, a.name, a.value FROM axis a JOIN run r ON r.id = a.run"
            " WHERE r.study = ?",
            (study,),
        ):
            axes.setdefault(run, {})[name] = label_text(value)
        known = list(dict.fromkeys(name for labels in axes.values() for name in labels))
        where = {name: label_text(label) for name, label in where.items()}
        for name, label in where.items():
            if name not in known:
                raise UserError(
                    f"{self.file}: study {study!r} has no axis {name!r}; it has: {', '.join(known)}"
                )
            labels = list(dict.fromkeys(l[name] for l in axes.values() if name in l))
            if label not in labels:
                raise UserError(
                    f"{self.file}: axis {name} has no {label!r}; it has: {', '.join(labels)}"
                )
        runs, failed = [], 0
        for run, repetition, status in self.rows(
            "SELECT id, repetition, status FROM run WHERE study = ? ORDER BY id", (study,)
        ):
            labels = axes.get(run, {})
            if all(labels.get(name) == label for name, label in where.items()):
                if status == "ok":
                    runs.append((run, repetition, labels))
                else:
                    failed += 1
        if not runs:
            raise UserError(f"{self.file}: study {study!r} has no finished run with these labels")
        return Selection(self, study, known, runs, failed)


class Selection:
    """Runs of a study, by cell (its axis labels) and repetition."""

    def __init__(self, database, study, axes, runs, failed):
        self.study = study
        self.axes = axes  # names, in the order of the study
        self.failed = failed
        self._database = database
        cell_keys = {}
        repetitions = sorted({repetition for _, repetition, _ in runs})
        place = {repetition: i for i, repetition in enumerate(repetitions)}
        rows = []
        for run, repetition, labels in runs:
            key = tuple(labels.get(axis, "") for axis in axes)
            rows.append((run, cell_keys.setdefault(key, len(cell_keys)), place[repetition]))
        self.cells = [dict(zip(axes, key)) for key in cell_keys]
        self.repetitions = len(repetitions)
        self._runs = {(cell, repetitions[place]): run for run, cell, place in rows}
        database.rows("DROP TABLE IF EXISTS temp.chosen")
        database.rows(
            "CREATE TEMP TABLE chosen(run INTEGER PRIMARY KEY, cell INTEGER, repetition INTEGER,"
            " end_s REAL)"
        )
        database.insert("INSERT INTO temp.chosen VALUES (?, ?, ?, NULL)", rows)

    def require_axes(self, *drawn):
        """@raises UserError if an axis that is not drawn still has several labels: cells would be
        mixed, or all but one dropped."""
        for axis in self.axes:
            found = self.labels(axis)
            if axis not in drawn and len(found) > 1:
                raise UserError(
                    f"{self._database.file}: choose one {axis} with --{axis}: {', '.join(found)}"
                )

    def described(self, *drawn):
        """The labels of the axes that are not drawn, for a caption."""
        return ", ".join(
            f"{self.labels(a)[0]} sensors" if a == "sensors"
            else f"{percent(self.labels(a)[0])} loss" if a == "loss"
            else f"talk {self.labels(a)[0]}" if a == "phase"
            else f"{a} {self.labels(a)[0]}"
            for a in sorted(self.axes, key=lambda a: (a == "phase", a == "loss"))
            if a not in drawn
        )

    def labels(self, axis):
        """Labels of an axis among these runs, in the order of the study."""
        if axis not in self.axes:
            raise UserError(f"{self._database.file}: study {self.study!r} has no axis {axis!r}")
        return list(dict.fromkeys(cell[axis] for cell in self.cells))

    def cell(self, **labels):
        """Number of the cell with these labels, or None."""
        for i, cell in enumerate(self.cells):
            if all(cell.get(name) == label for name, label in labels.items()):
                return i
        return None

    def series(self, names, at_end=False, subject=None):
        """Series by name, with all instants or, `at_end`, the last one alone; over all subjects or
        about one. @raises UserError if none of these runs has one of the names."""
        condition = f"s.name IN ({', '.join('?' * len(names))})"
        if at_end:
            self.note_ends()
            condition += " AND s.t_s = c.end_s"
        values = "s.value"
        if subject is not None:
            condition += " AND s.subject = ?"
        elif self._has_many_subjects(names):  # let SQLite sum over them: fewer rows to hand over
            values = "TOTAL(s.value), TOTAL(s.value * s.value), COUNT(s.value), COUNT(*)"
            condition += " GROUP BY c.run, s.t_s, s.agent, s.name"
        rows = self._database.rows(
            f"SELECT s.name, c.cell, c.repetition, s.t_s, s.agent, {values}"
            f" FROM temp.chosen c CROSS JOIN series s ON s.run = c.run WHERE {condition}",
            (*names, *([] if subject is None else [subject])),
        )
        found = {}
        if rows:
            name, cell, repetition, t_s, agent, *values = zip(*rows)
            places = {n: i for i, n in enumerate(names)}
            name = np.array([places[n] for n in name])
            keys = [np.array(c) for c in (cell, repetition, t_s, agent)]
            if at_end:  # cells may end at different times
                keys[2] = np.zeros(len(rows))
            values = [np.array(v, dtype=float) for v in values]  # None becomes NaN
            for n, i in places.items():
                of_name = name == i
                if of_name.any():
                    found[n] = Series(
                        self, [k[of_name] for k in keys], [v[of_name] for v in values]
                    )
        for n in names:
            if n not in found:
                raise UserError(
                    f"{self._database.file}: no series {n!r} in these runs of {self.study!r};"
                    " name it under [record] in the scenario"
                )
        return found

    def subjects(self, name):
        """What the first of these runs says a series is about, in the order of its rows."""
        rows = self._database.rows(
            "SELECT DISTINCT subject FROM series WHERE run = (SELECT MIN(run) FROM temp.chosen)"
            " AND name = ?",
            (name,),
        )
        return [subject for (subject,) in rows]

    def run(self, cell, repetition):
        """Number of the run of a cell. @raises UserError if it did not finish or is not there."""
        if (cell, repetition) not in self._runs:
            known = sorted(r for c, r in self._runs if c == cell)
            there = f"{known[0]} … {known[-1]}" if known else "none"
            raise UserError(
                f"{self._database.file}: no finished repetition {repetition}; there are: {there}"
            )
        return self._runs[cell, repetition]

    def rows(self, sql, parameters=()):
        """Of the database; temp.chosen(run, cell, repetition, end_s) are these runs."""
        return self._database.rows(sql, parameters)

    @property
    def file(self):
        """The database's name."""
        return self._database.file

    def _has_many_subjects(self, names):
        return 1 < self._database.rows(
            "SELECT COUNT(DISTINCT subject) FROM series"
            " WHERE run = (SELECT MIN(run) FROM temp.chosen) AND name = ?",
            (names[0],),
        )[0][0]

    def note_ends(self):
        """Writes its last instant beside each run; that of a cell's first run holds for all."""
        self._database.rows(
            "CREATE TEMP TABLE IF NOT EXISTS cell_end AS SELECT cell,"
            " (SELECT MAX(t_s) FROM series WHERE run = first) AS end_s"
            " FROM (SELECT cell, MIN(run) AS first FROM temp.chosen GROUP BY cell)"
        )
        self._database.rows(
            "UPDATE temp.chosen SET end_s ="
            " (SELECT e.end_s FROM temp.cell_end e WHERE e.cell = chosen.cell)"
        )

    def has_series(self, name):
        """Whether the first of these runs recorded that series."""
        return bool(
            self._database.rows(
                "SELECT 1 FROM series WHERE run = (SELECT MIN(run) FROM temp.chosen)"
                " AND name = ? LIMIT 1",
                (name,),
            )
        )

    def agents_named(self, beginning):
        """Numbers of the agents whose names begin so. @raises UserError if there are none."""
        rows = self._database.rows(
            "SELECT id, name FROM agent WHERE run = (SELECT MIN(run) FROM temp.chosen) ORDER BY id"
        )
        found = [number for number, name in rows if number >= 0 and name.startswith(beginning)]
        if not found:
            names = ", ".join(name for number, name in rows if number >= 0)
            raise UserError(
                f"{self._database.file}: no agent's name begins with {beginning!r}; there are: {names}"
            )
        return found

    def scalar(self, name):
        """{agent: array[cell, repetition]} of a scalar; empty if it was not recorded."""
        found = {}
        for cell, repetition, agent, value in self._database.rows(
            "SELECT c.cell, c.repetition, s.agent, s.value FROM temp.chosen c CROSS JOIN scalar s"
            " ON s.run = c.run WHERE s.name = ?",
            (name,),
        ):
            shape = (len(self.cells), self.repetitions)
            array = found.setdefault(agent, np.full(shape, np.nan))
            array[cell, repetition] = np.nan if value is None else value
        return found

    def agent(self, name):
        """Number of the agent of that name. @raises UserError if there is none."""
        found = self._database.rows(
            "SELECT id FROM agent WHERE run = (SELECT MIN(run) FROM temp.chosen) AND name = ?",
            (name,),
        )
        if not found:
            raise UserError(f"{self._database.file}: no agent {name!r} in these runs")
        return found[0][0]

    def agent_names(self):
        """{number: name} of all agents."""
        return dict(self._database.rows(
            "SELECT id, name FROM agent WHERE run = (SELECT MIN(run) FROM temp.chosen)"))

    def scalar_of(self, name, agent):
        """array[cell, repetition] of a scalar of one agent, NaN where it is undefined.
        @raises UserError if it was not recorded."""
        values = self.scalar(name).get(agent)
        if values is None:
            raise UserError(f"{self._database.file}: no scalar {name!r} of agent {agent}")
        return values

    def link_shares(self, cell, repetition=0):
        """Which share of its packets each link delivered, one number a link, in one run."""
        rows = self._database.rows(
            "SELECT SUM(l.packets * (l.fate = 'delivered')), SUM(l.packets)"
            " FROM temp.chosen c JOIN link l ON l.run = c.run"
            " WHERE c.cell = ? AND c.repetition = ? GROUP BY l.sender, l.receiver",
            (cell, repetition),
        )
        return np.array([delivered / packets for delivered, packets in rows])

    def state_dimension(self):
        """n of the χ² that NEES follows."""
        values = self.scalar("state_dimension").get(CENTRAL)
        found = [] if values is None else np.unique(values[np.isfinite(values)])
        if len(found) != 1:
            raise UserError(
                f"{self._database.file}: the runs have "
                + ("several state dimensions" if len(found) else "no scalar 'state_dimension'")
            )
        return int(found[0])


class Series:
    """One metric: values over cells, repetitions, instants, agents, with subjects summed up.

    `total`, `squares` are sums over subjects of values and of their squares, `count` how many were
    defined (not NULL), `asked` how many there could have been. Shape [cell, repetition, t, agent].
    """

    def __init__(self, selection, keys, values):
        """`keys`: columns of cell, repetition, instant, agent. `values`: a column of values, or the
        four sums."""
        cell, repetition, t_s, agent = keys
        self.cells = range(len(selection.cells))
        self.t_s, t = np.unique(t_s, return_inverse=True)
        self.agents, a = np.unique(agent, return_inverse=True)
        shape = (len(selection.cells), selection.repetitions, len(self.t_s), len(self.agents))
        flat = np.ravel_multi_index((cell, repetition, t, a), shape)
        if len(values) == 1:
            defined = np.isfinite(values[0])
            clean = np.where(defined, values[0], 0.0)
            with np.errstate(over="ignore"):
                values = [clean, clean * clean, defined.astype(float), np.ones(len(clean))]
        self.total, self.squares, self.count, self.asked = (
            np.bincount(flat, weights=v, minlength=int(np.prod(shape))).reshape(shape)
            for v in values
        )
        self._parts = {}

    def of(self, array, agents):
        """"total", "squares", "count" or "asked" for "agents", "central" or the agent of a number
        alone."""
        if (array, agents) not in self._parts:
            if agents == "agents":
                chosen = self.agents >= 0
            else:
                chosen = self.agents == (CENTRAL if agents == "central" else agents)
            self._parts[array, agents] = getattr(self, array)[..., chosen]
        return self._parts[array, agents]
