# SPDX-License-Identifier: MIT
"""Writes MDF4 files for the tests, by the format's description (ASAM MDF 4.1): frames of CAN buses
as loggers have them, or measured signals. Shares nothing with the reader, which Debian has no other
program to compare with.

    write_frames('a.mf4', frames, start_ns, variable='records', deflate='transposed')

A frame is (time in ns from start_ns, channel, id, extended, data, kind); kind 'data', 'remote',
'error' or 'fd'.
"""
import struct
import zlib

UNSIGNED, SIGNED, REAL, BYTES = 0, 2, 4, 10
FIXED, VARIABLE, MASTER = 0, 1, 2
NAMES = {'data': 'CAN_DataFrame', 'remote': 'CAN_RemoteFrame', 'error': 'CAN_ErrorFrame'}


class File:
    def __init__(self, version=b'4.11    ', lacks=None):
        self.lacks = lacks
        mark = b'MDF     ' if lacks is None else b'UnFinMF '
        self.bytes = bytearray(mark + version + b'tests   ' + b'\0' * 4 + struct.pack('<H', 411) +
                               b'\0' * 30 + struct.pack('<HH', lacks or 0, 0))

    def block(self, name, links=(), data=b'', length=None):
        """Appends a block; its address."""
        self.bytes += b'\0' * (-len(self.bytes) % 8)
        at = len(self.bytes)
        whole = 24 + 8 * len(links) + len(data) if length is None else length
        self.bytes += b'##' + name + b'\0' * 4 + struct.pack('<QQ', whole, len(links))
        self.bytes += struct.pack('<%dQ' % len(links), *links) + data
        return at

    def link(self, block, number, target):
        struct.pack_into('<Q', self.bytes, block + 24 + 8 * number, target)

    def text(self, text):
        return self.block(b'TX', data=text.encode() + b'\0') if text else 0

    def header(self, start_ns, local=False):
        return self.block(b'HD', [0] * 6, struct.pack('<QhhBBBBdd', start_ns, 0, 0, local, 0, 0, 0, 0.0, 0.0))

    def channel(self, name, place, bits, data_type=UNSIGNED, bit=0, kind=FIXED, linear=None, unit='',
                data=0, part=0, flags=0, invalid=0):
        conversion = 0
        if linear:
            conversion = self.block(b'CC', [0] * 4, struct.pack('<BBHHHdddd', 1, 0, 0, 0, 2, 0.0, 0.0, *linear))
        return self.block(b'CN', [0, part, self.text(name), 0, conversion, data, self.text(unit), 0],
                          struct.pack('<BBBBIIIIBBH6d', kind, kind == MASTER, data_type, bit, place, bits,
                                      flags, invalid, 0, 0, 0, *[0.0] * 6))

    def group(self, channels, name, record_id, cycles, flags, size, invalidation=0):
        for before, after in zip(channels, channels[1:]):
            self.link(before, 0, after)
        if self.lacks is not None:
            cycles = 0
        return self.block(b'CG', [0, channels[0] if channels else 0, self.text(name), 0, 0, 0],
                          struct.pack('<QQHHIII', record_id, cycles, flags, 0, 0, size, invalidation))

    def data_group(self, groups, data, id_bytes):
        for before, after in zip(groups, groups[1:]):
            self.link(before, 0, after)
        return self.block(b'DG', [0, groups[0], data, 0], struct.pack('<B7x', id_bytes))

    def data(self, content, name=b'DT', deflate=None, pieces=None, columns=1):
        """Data plain, deflated or transposed, in one block or in lists of three blocks."""
        def piece(part):
            if not deflate:
                return self.block(name, data=part)
            plain = part
            if deflate == 'transposed':
                rows = len(part) // columns
                part = b''.join(part[c:rows * columns:columns] for c in range(columns)) + part[rows * columns:]
            packed = zlib.compress(part)
            return self.block(b'DZ', data=struct.pack('<2sBBIQQ', name, deflate == 'transposed', 0,
                                                      columns if deflate == 'transposed' else 0,
                                                      len(plain), len(packed)) + packed)
        if not pieces:
            return piece(content)
        size = -(-len(content) // pieces)
        blocks = [piece(content[i:i + size]) for i in range(0, len(content), size)]
        lists = []
        for i in range(0, len(blocks), 3):
            part = blocks[i:i + 3]
            lists.append(self.block(b'DL', [0] + part, struct.pack('<B3xI%dQ' % len(part), 0, len(part),
                                                                     *[size * (i + k) for k in range(len(part))])))
        for before, after in zip(lists, lists[1:]):
            self.link(before, 0, after)
        if deflate:
            return self.block(b'HL', lists[:1], struct.pack('<HB5x', 0, deflate == 'transposed'))
        return lists[0]

    def save(self, path, groups):
        header = 64
        for before, after in zip(groups, groups[1:]):
            self.link(before, 0, after)
        self.link(header, 0, groups[0])
        with open(path, 'wb') as out:
            out.write(self.bytes)


SIZES = [0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64]


def frame_record(frame, stamp, place, width):
    """time 8, channel 1, ID 4, IDE | EDL | BRS in one byte, DLC 1, DataLength 1, DataBytes."""
    _, channel, identifier, extended, data, kind = frame
    flags = extended | (kind == 'fd') << 1 | (kind == 'fd') << 2
    head = stamp + struct.pack('<BIBBB', channel, identifier, flags, SIZES.index(len(data)), len(data))
    if kind == 'remote' or kind == 'error':
        return head
    return head + (struct.pack('<Q', place) if width is None else data.ljust(width, b'\0'))


def write_frames(path, frames, start_ns=0, sort=False, variable=None, deflate=None, pieces=None,
                 time='integer', lacks=None, local=False, id_bytes=1, change=None):
    """variable: None (bytes in the record), 'data' (a block SD) or 'records' (a group of its own).
    sort: a data group for each kind and channel. time: 'integer' (10 ns) or 'real'."""
    out = File(lacks=lacks)
    out.header(start_ns, local)
    kind_of = lambda f: 'data' if f[5] == 'fd' else f[5]
    keys = sorted({(kind_of(f), f[1]) for f in frames})
    chosen = [[k] for k in keys] if sort else [keys]
    width = max([8] + [len(f[4]) for f in frames])
    data_groups = []
    for keys in chosen:
        groups, content, values = [], b'', {k: b'' for k in keys}
        ids = {k: 1 + 2 * i for i, k in enumerate(keys)}
        for frame in frames:
            key = (kind_of(frame), frame[1])
            if key not in keys:
                continue
            stamp = struct.pack('<Q', frame[0] // 10) if time == 'integer' else struct.pack('<d', frame[0] * 1e-9)
            has_value = variable and key[0] == 'data'
            record = frame_record(frame, stamp, len(values[key]), None if variable else width)
            value = struct.pack('<I', len(frame[4])) + frame[4]
            mark = lambda i: b'' if sort else i.to_bytes(id_bytes, 'little')
            content += mark(ids[key]) + record
            if has_value:
                values[key] += value
                if variable == 'records':
                    content += mark(ids[key] + 1) + value
        at = out.data(content, deflate=deflate, pieces=pieces, columns=len(content) // max(1, len(frames)) or 1) \
            if lacks is None else 0
        for key in keys:
            name = NAMES[key[0]]
            count = sum((kind_of(f), f[1]) == key for f in frames)
            size = 16 + (0 if key[0] != 'data' else 8 if variable else width)
            place, more = 0, []
            if variable == 'data' and key[0] == 'data':
                place = out.data(values[key], name=b'SD', deflate='plain' if deflate else None, pieces=pieces)
            if variable == 'records' and key[0] == 'data':
                more = [out.group([], '', ids[key] + 1, count, 1, 0)]
                place = more[0]
            parts = [out.channel(name + '.BusChannel', 8, 8), out.channel(name + '.ID', 9, 29),
                     out.channel(name + '.IDE', 13, 1), out.channel(name + '.EDL', 13, 1, bit=1),
                     out.channel(name + '.BRS', 13, 1, bit=2), out.channel(name + '.DLC', 14, 4),
                     out.channel(name + '.DataLength', 15, 8)]
            if key[0] == 'data':
                parts.append(out.channel(name + '.DataBytes', 16, 64, BYTES, kind=VARIABLE, data=place) if variable
                             else out.channel(name + '.DataBytes', 16, 8 * width, BYTES))
            for before, after in zip(parts, parts[1:]):
                out.link(before, 0, after)
            frame_channel = out.channel(name, 8, 8 * (size - 8), BYTES, part=parts[0])
            stamps = out.channel('Timestamp', 0, 64, UNSIGNED, kind=MASTER, linear=(0.0, 1e-8), unit='s') \
                if time == 'integer' else out.channel('Timestamp', 0, 64, REAL, kind=MASTER, unit='s')
            groups += [out.group([stamps, frame_channel], 'CAN%d' % key[1], ids[key], count, 2, size)] + more
        data_groups.append(out.data_group(groups, at, 0 if sort else id_bytes))
    if lacks is not None:  # the data at the end, without a length
        out.link(data_groups[0], 2, out.block(b'DT', data=content, length=24))
    if change:
        change(out)
    out.save(path, data_groups)


def write_signals(path, names, rows, start_ns=0, units=None, deflate=None, pieces=None):
    """Columns of doubles, the first one the time in s; the last one as 32 bits of a linear conversion
    (1e-6), with a bit that says whether it is invalid."""
    out = File()
    out.header(start_ns)
    units = units or [''] * len(names)
    size = 8 * (len(names) - 1) + 4
    content = b''
    for row in rows:
        content += struct.pack('<%dd' % (len(names) - 1), *row[:-1])
        invalid = row[-1] != row[-1]
        content += struct.pack('<iB', 0 if invalid else round(1e6 * row[-1]), invalid)
    at = out.data(content, deflate=deflate, pieces=pieces, columns=size + 1)
    channels = [out.channel('t', 0, 64, REAL, kind=MASTER, unit='s')]
    for i, name in enumerate(names[1:-1]):
        channels.append(out.channel(name, 8 + 8 * i, 64, REAL, unit=units[i + 1]))
    channels.append(out.channel(names[-1], size - 4, 32, SIGNED, linear=(0.0, 1e-6), unit=units[-1], flags=2))
    text = out.channel('remark', 0, 64, 7)
    out.save(path, [out.data_group([out.group(channels + [text], '', 0, len(rows), 0, size, 1)], at, 0)])


def read_candump(path):
    """The lines of a log as frames, and the first full second in ns."""
    frames, start_ns = [], None
    for line in open(path):
        stamp, interface, text = line.split()[:3]
        seconds, fraction = stamp.strip('()').split('.')
        ns = int(seconds) * 10**9 + int(fraction.ljust(9, '0'))
        start_ns = ns // 10**9 * 10**9 if start_ns is None else start_ns
        identifier, data = text.split('#')
        frames.append((ns - start_ns, 1 + int(interface[-1]), int(identifier, 16), len(identifier) == 8,
                       bytes.fromhex(data), 'data'))
    return frames, start_ns
