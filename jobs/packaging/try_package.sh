#!/usr/bin/env bash
# Installs the .deb, uses it as a new user would, removes it, and looks for what is left. As root, on a Debian 12 that
# may be lost: a container or a chroot. It calls apt. It ends with "the package works" and exit code 0.
# Usage: jobs/packaging/try_package.sh FILE.deb
set -euo pipefail
package=$(realpath "$1")
unset PYTHONDONTWRITEBYTECODE  # Python may leave files behind
export DEBIAN_FRONTEND=noninteractive OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1

apt-get update -qq
apt-get install -y -qq --no-install-recommends man-db bash-completion zsh
before=$(mktemp)
list_files() { find / -xdev -path /proc -prune -o -path /sys -prune -o -path /tmp -prune -o -name '*impinge*' -print; }
list_files > "$before"
# Without recommended packages, as in a small container.
apt-get install -y -qq --no-install-recommends "$package"

folder=$(mktemp -d)
cd "$folder"
impinge --version
impinge --new jet > jet.toml
coarse=(--set particles.spacing=0.04 --set time.dt=6.4e-3 --set time.end=1.0)
impinge jet.toml --check "${coarse[@]}" > /dev/null
impinge jet.toml "${coarse[@]}" --set output.directory=alone > /dev/null
mpirun --oversubscribe -n 2 impinge jet.toml "${coarse[@]}"
impinge-validate output/jet
impinge-plot output/jet
impinge-report output/jet
python3 -c 'import impinge; print(impinge.Run("output/jet").snapshot().pressure.max(), "Pa")'
ls output/jet/jet_report.html output/jet/validation/*.png output/jet/jet_figures/*.png

for page in impinge impinge-validate impinge-plot impinge-report impinge-case; do
  MANWIDTH=100 man --warnings "$page" > page.txt 2> warnings.txt
  grep -q "^NAME" page.txt
  if [ -s warnings.txt ]; then cat warnings.txt; exit 1; fi
done

# A terminal's bash, as completion loads the function.
found=$(bash -c '. /usr/share/bash-completion/bash_completion; _completion_loader impinge
  COMP_WORDS=(impinge --ne) COMP_CWORD=1; _impinge; echo "${COMPREPLY[@]}"')
[ "$found" = --new ]
# A terminal's zsh, with a word to complete and a tab.
found=$(zsh -f -c 'zmodload zsh/zpty; zpty shell zsh -f -i
  zpty -w shell "PS1=; autoload -Uz compinit; compinit -u -D; cd '"$folder"'"; sleep 3
  zpty -n -w shell $'"'"'impinge --set kernel.type=no\t'"'"'; sleep 3
  while zpty -r -t shell line; do print -r -- $line; done')
[[ $found == *kernel.type=non_singular* ]] || { echo "zsh completes to: $found"; exit 1; }

apt-get remove -y -qq impinge
cd /
rm -rf "$folder"
list_files | diff "$before" - || { echo "left behind"; exit 1; }
echo "the package works"
