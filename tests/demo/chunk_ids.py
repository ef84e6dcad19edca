"""chunk_ids.py OUT.eco: the ids of a pack's chunks, as .../chunks/ID has them, a line each."""
import struct
import sys

pack = open(sys.argv[1], "rb").read()
for i in range(struct.unpack_from("<I", pack, 12)[0]):
    kind, count, at = struct.unpack_from("<IIQ", pack, 32 + 40 * i)
    if kind == 11:
        print("\n".join(pack[at + 36 * k:at + 36 * k + 16].hex() for k in range(count)))
