# Sourced from the root of the repository: puts the Python peers' packages into a place of their own, `$python` runs with them.
requirements=benches/peers/requirements.txt
venv=${CARGO_TARGET_DIR:-target}/peers/venv
python3 -c 'import tomllib, ensurepip' 2>/dev/null ||
    { echo "Python 3.11 or newer with venv is missing: apt-get install python3-venv" >&2; exit 2; }
if [ ! "$venv/ready" -nt $requirements ]; then
    python3 -m venv "$venv"
    "$venv/bin/python" -m pip install --quiet --disable-pip-version-check -r $requirements
    touch "$venv/ready"
fi
python=$venv/bin/python
