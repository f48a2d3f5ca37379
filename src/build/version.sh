# Write the module that tells which program this is, if it would differ from what stands there.
# usage: sh version.sh FILE VERSION MODE
file=$1
commit=unknown
if [ "$(git rev-parse --show-toplevel 2>/dev/null)" = "$(pwd -P)" ]; then
  commit=$(git describe --always --dirty=+ --abbrev=12 --exclude='*' 2>/dev/null) || commit=unknown
fi
mkdir -p "$(dirname "$file")"
cat >"$file.new" <<END
!> Which program this is; written by the build.
module version
  implicit none
  private
  public :: program_version, git_commit, build_mode

  character(len=*), parameter :: program_version = '$2'
  character(len=*), parameter :: git_commit = '$commit'  !< a trailing + means changed since
  character(len=*), parameter :: build_mode = '$3'
end module version
END
if cmp -s "$file.new" "$file"; then rm "$file.new"; else mv "$file.new" "$file"; fi
