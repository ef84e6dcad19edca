#!/bin/sh
# Files of a few megabytes that ask for gigabytes, as zip files and databases can: none takes much more than 1 GiB, and what is refused for
# it says how to allow more. BUILD is the folder of the programs. Prints what failed; status 0 when nothing did.
set -u
BUILD=${BUILD:-build}
# sanitizers take address space of their own: the child has no limit there
case $BUILD in */sanitize*|*/thread*|*/fuzz*) echo "test_unpack: skipped: no limit of memory under sanitizers"; exit 77 ;; esac
command -v python3 >/dev/null || { echo "test_unpack: skipped: no python3"; exit 77; }
DIR=$(mktemp -d)
trap 'rm -rf "$DIR"' EXIT
printf 'v -0.05 0 0\nv 0.05 0 0\nv 0 0 1\nf 1 2 3\n' >"$DIR/blade.obj"

python3 - "$(realpath "$BUILD")/ecopack" "$DIR" <<'PYTHON'
import os, resource, sqlite3, struct, subprocess, sys, zlib

ECOPACK, DIR = sys.argv[1:]
MB = 10 ** 6
MOST_KB = 1_300_000                     # of each process, with 1 GiB for what it reads
REFUSED = ("vertices.3mf", "one_cell.xlsx", "one_cell.ods", "text.kmz", "view.gpkg")
failed = 0
os.chdir(DIR)


def zip_file(path, parts):
    """Parts are (name, head, block, times, tail): the block is compressed once and its code repeated."""
    directory, at = b"", 0
    with open(path, "wb") as out:
        for name, head, block, times, tail in parts:
            pack = zlib.compressobj(9, zlib.DEFLATED, -15)
            code = pack.compress(head) + pack.flush(zlib.Z_FULL_FLUSH)
            once = pack.compress(block) + pack.flush(zlib.Z_FULL_FLUSH)
            code += once * times + pack.compress(tail) + pack.flush()
            crc = zlib.crc32(head)
            for _ in range(times):
                crc = zlib.crc32(block, crc)
            crc = zlib.crc32(tail, crc)
            fields = struct.pack("<HHHIIIIHH", 20, 0, 8, 0, crc, len(code), len(head) + len(block) * times + len(tail), len(name), 0)
            out.write(b"PK\3\4" + fields + name + code)
            directory += b"PK\1\2" + struct.pack("<H", 20) + fields + struct.pack("<HHHII", 0, 0, 0, 0, at) + name
            at = out.tell()
        out.write(directory + b"PK\5\6" + struct.pack("<HHHHIIH", 0, 0, len(parts), len(parts), len(directory), at, 0))


def small(name, text):
    return name, text, b"", 0, b""


def workbook(path, before, block, times, after):
    kind = b"http://schemas.openxmlformats.org/officeDocument/2006/relationships"
    package = b"http://schemas.openxmlformats.org/package/2006/"
    sheet = b"application/vnd.openxmlformats-officedocument.spreadsheetml."
    relation = b'<Relationships xmlns="' + package + b'relationships"><Relationship Id="r" Type="' + kind + b'/%s" Target="%s"/></Relationships>'
    main = b'xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main"'
    zip_file(path, [
        small(b"[Content_Types].xml", b'<Types xmlns="' + package + b'content-types"><Override PartName="/xl/workbook.xml" ContentType="' +
              sheet + b'sheet.main+xml"/><Override PartName="/xl/worksheets/sheet1.xml" ContentType="' + sheet + b'worksheet+xml"/></Types>'),
        small(b"_rels/.rels", relation % (b"officeDocument", b"xl/workbook.xml")),
        small(b"xl/workbook.xml", b"<workbook " + main + b' xmlns:r="' + kind + b'"><sheets><sheet name="s" sheetId="1" r:id="r"/></sheets>'
              b"</workbook>"),
        small(b"xl/_rels/workbook.xml.rels", relation % (b"worksheet", b"worksheets/sheet1.xml")),
        (b"xl/worksheets/sheet1.xml", b"<worksheet " + main + b'><sheetData><row r="1"><c r="A1" t="inlineStr"><is><t>x</t></is></c><c r="B1" '
         b't="inlineStr"><is><t>y</t></is></c><c r="C1" t="inlineStr"><is><t>name</t></is></c></row>' + before, block, times,
         after + b"</sheetData></worksheet>")])


def open_document(path, before, block, times, after):
    urn = b"urn:oasis:names:tc:opendocument:xmlns:"
    zip_file(path, [
        small(b"mimetype", b"application/vnd.oasis.opendocument.spreadsheet"),
        (b"content.xml", b'<office:document-content xmlns:office="' + urn + b'office:1.0" xmlns:table="' + urn + b'table:1.0" xmlns:text="' +
         urn + b'text:1.0"><office:body><office:spreadsheet><table:table table:name="s"><table:table-row>' +
         b"".join(b'<table:table-cell office:value-type="string"><text:p>%s</text:p></table:table-cell>' % n for n in (b"x", b"y", b"name")) +
         b"</table:table-row>" + before, block, times,
         after + b"</table:table></office:spreadsheet></office:body></office:document-content>")])


def model_3mf(path, vertices):
    core = b"http://schemas.microsoft.com/3dmanufacturing/"
    package = b"http://schemas.openxmlformats.org/package/2006/"
    zip_file(path, [
        small(b"[Content_Types].xml", b'<Types xmlns="' + package + b'content-types"><Default Extension="model" ContentType="application/vnd.ms-'
              b'package.3dmanufacturing-3dmodel+xml"/></Types>'),
        small(b"_rels/.rels", b'<Relationships xmlns="' + package + b'relationships"><Relationship Id="r" Target="/3D/3dmodel.model" Type="' +
              core + b'2013/01/3dmodel"/></Relationships>'),
        (b"3D/3dmodel.model", b'<model unit="meter" xmlns="' + core + b'core/2015/02"><resources><object id="1" type="model"><mesh><vertices>',
         b'<vertex x="0" y="0" z="0"/>' * 10000, vertices // 10000,
         b'<vertex x="1" y="0" z="0"/><vertex x="0" y="0" z="1"/></vertices><triangles><triangle v1="0" v2="%d" v3="%d"/></triangles></mesh>'
         b'</object></resources><build><item objectid="1"/></build></model>' % (vertices, vertices + 1))])


def model_zae(path, numbers):
    zip_file(path, [
        small(b"manifest.xml", b"<dae_root>a.dae</dae_root>"),
        (b"a.dae", b'<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><library_geometries><geometry id="g"><mesh>'
         b'<source id="p"><float_array id="a" count="%d">' % numbers, b"0 " * 500000, numbers // 500000,
         b'</float_array><technique_common><accessor source="#a" count="%d" stride="3"/></technique_common></source><vertices id="v"><input '
         b'semantic="POSITION" source="#p"/></vertices><triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p>'
         b"</triangles></mesh></geometry></library_geometries></COLLADA>" % (numbers // 3))])


def database(path, select, geopackage):
    d = sqlite3.connect(path)
    if geopackage:
        d.executescript(
            "PRAGMA application_id=0x47504B47; PRAGMA user_version=10200;"
            "CREATE TABLE gpkg_spatial_ref_sys(srs_name TEXT NOT NULL, srs_id INTEGER PRIMARY KEY, organization TEXT NOT NULL, "
            "organization_coordsys_id INTEGER NOT NULL, definition TEXT NOT NULL, description TEXT);"
            "INSERT INTO gpkg_spatial_ref_sys VALUES('u', 0, 'NONE', 0, 'undefined', ''), ('u', -1, 'NONE', -1, 'undefined', '');"
            "CREATE TABLE gpkg_contents(table_name TEXT NOT NULL PRIMARY KEY, data_type TEXT NOT NULL, identifier TEXT UNIQUE, description "
            "TEXT, last_change DATETIME, min_x DOUBLE, min_y DOUBLE, max_x DOUBLE, max_y DOUBLE, srs_id INTEGER);"
            "CREATE TABLE gpkg_geometry_columns(table_name TEXT NOT NULL, column_name TEXT NOT NULL, geometry_type_name TEXT NOT NULL, "
            "srs_id INTEGER NOT NULL, z TINYINT NOT NULL, m TINYINT NOT NULL);"
            "INSERT INTO gpkg_contents(table_name, data_type, identifier, srs_id) VALUES('t', 'attributes', 't', 0);")
    d.execute("CREATE VIEW t AS SELECT 1 AS fid, 1.0 AS x, 2.0 AS y, " + select + " AS name")
    d.commit()
    d.close()


def cell(letter):
    return b'<row r="2"><c r="A2"><v>1</v></c><c r="B2"><v>2</v></c><c r="%s2" t="inlineStr"><is><t>' % letter


model_3mf("vertices.3mf", 20 * MB)
model_zae("numbers.zae", 300 * MB)
workbook("one_cell.xlsx", cell(b"C"), b"a" * MB, 900, b"</t></is></c></row>")
open_document("one_cell.ods", b'<table:table-row><table:table-cell office:value-type="string"><text:p>', b"a" * MB, 900,
              b"</text:p></table:table-cell></table:table-row>")
open_document("repeated.ods", b"", b'<table:table-row table:number-rows-repeated="1000000"><table:table-cell office:value-type="float" '
              b'office:value="1" table:number-columns-repeated="1000"/></table:table-row>', 30, b"")
zip_file("text.kmz", [(b"doc.kml", b'<kml xmlns="http://www.opengis.net/kml/2.2"><Document><Placemark><name>', b"a" * MB, 900,
                       b"</name><Point><coordinates>1,2</coordinates></Point></Placemark></Document></kml>")])
database("view.gpkg", "hex(zeroblob(225000000)) || hex(zeroblob(225000000))", True)
database("blob.gpkg", "zeroblob(900000000)", True)
database("view.sqlite", "replace(hex(zeroblob(100000000)), '00', 'aaaaaaaaa')", False)
open("sql.vrt", "w").write('<OGRVRTDataSource><OGRVRTLayer name="t"><SrcDataSource>view.gpkg</SrcDataSource><SrcSQL dialect="SQLITE">SELECT '
                           "1.0 AS x, 2.0 AS y, hex(zeroblob(450000000)) AS name</SrcSQL></OGRVRTLayer></OGRVRTDataSource>")


def run(name, *command):
    """Runs a command; its output, status and the most memory that it or a child of it had, kB."""
    text = "import resource, subprocess, sys; r = subprocess.run(sys.argv[1:], stdout=2); " \
        "print(r.returncode, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)"
    r = subprocess.run([sys.executable, "-c", text, *command], stdin=subprocess.DEVNULL, capture_output=True, text=True)
    status, most_kb = map(int, r.stdout.split())
    return r.stderr, status, most_kb


def look(name, *command):
    global failed
    said, status, most_kb = run(name, *command)
    size = os.path.getsize(name)
    print("# %s, %d bytes: status %d, at most %d kB" % (name, size, status, most_kb))
    if size > 5 * MB:
        problem = "has %d bytes: not small" % size
    elif most_kb > MOST_KB:
        problem = "takes %d kB" % most_kb
    elif status not in (0, 1) or "ended with" in said or (status == 1 and "ecopack: " not in said):
        problem = "status %d: %s" % (status, said[:400])
    elif name in REFUSED and (status != 1 or "ECO_IMPORT_MEMORY_GB" not in said):
        problem = "status %d, and does not say how to allow more: %s" % (status, said[:400])
    else:
        return
    failed = 1
    print("test_unpack: %s: %s" % (name, problem))


for name in ("vertices.3mf", "numbers.zae"):
    look(name, ECOPACK, "model", name)
for name in ("one_cell.xlsx", "one_cell.ods", "repeated.ods", "text.kmz", "view.gpkg", "blob.gpkg", "view.sqlite", "sql.vrt"):
    open("scene.json", "w").write('{"plants": {"p": {"model": "blade.obj"}}, "instances": [{"from": "%s", "plant": "p", "x": "x", "y": "y"}]}'
                                  % name)
    look(name, ECOPACK, "map", "scene.json", "-o", "map.png", "--quiet")
sys.exit(failed)
PYTHON
