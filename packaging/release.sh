#!/usr/bin/env bash
# All of a release that publishes nothing: checks tree and CHANGELOG, packages the crates and builds each from its package, builds
# wheels and source distribution, and sets the tag last. Publishing is `cargo publish` and `twine upload` by hand.
#
# Usage: packaging/release.sh
set -euo pipefail
cd "$(dirname "$0")/.."
target=${CARGO_TARGET_DIR:-target}
crates=(fric-core fric-log fric-lab fric-tendon fric-tendon-lab fric-work fric-cli)

refuse() {
    echo "no release: $1" >&2
    exit 1
}

version=$(sed -n '/^\[workspace.package\]/,/^\[/s/^version = "\(.*\)"/\1/p' Cargo.toml)
tag=v$version
changed=$(git status --porcelain)
[ -z "$changed" ] || refuse "there is what is not committed; commit or remove it:"$'\n'"$changed"
grep -Eq "^## \[${version//./\\.}\] - [0-9]{4}-[0-9]{2}-[0-9]{2}$" CHANGELOG.md ||
    refuse "CHANGELOG.md has no section for this version; write \"## [$version] - $(date +%F)\" above what it brings"
! git rev-parse -q --verify "refs/tags/$tag" >/dev/null || refuse "the tag $tag exists; raise the version in Cargo.toml"

echo "== packages of the crates, each built from what is in it and in those before it"
cargo package --quiet $(printf -- '-p %s ' "${crates[@]}")
for crate in "${crates[@]}"; do
    echo "  $target/package/$crate-$version.crate"
done

baseline=$(git describe --tags --abbrev=0 --match 'v*' 2>/dev/null || true)
if ! command -v cargo-semver-checks >/dev/null; then
    echo "not checked: whether the version fits what has changed; cargo-semver-checks is not installed"
elif [ -z "$baseline" ]; then
    echo "not checked: whether the version fits what has changed; there is no release to compare with"
else
    echo "== the version against what has changed since $baseline"
    cargo semver-checks $(printf -- '-p %s ' "${crates[@]}") --baseline-rev "$baseline"
fi

if command -v cargo-deny >/dev/null; then
    echo "== licences, advisories and sources"
    cargo deny check
else
    echo "not checked: licences and advisories; cargo-deny is not installed"
fi

echo "== wheels and source distribution"
packaging/wheel.sh "$target/wheels"

# What was built is what is tagged.
[ -z "$(git status --porcelain)" ] || refuse "building has changed the tree; see git status"
git tag -a "$tag" -m "fric $version"
echo "tagged $tag. To publish: cargo publish $(printf -- '-p %s ' "${crates[@]}")&& twine upload $target/wheels/* && git push origin $tag"
