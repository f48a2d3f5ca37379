!> Working precision of the whole program.
module kinds
  use, intrinsic :: iso_fortran_env, only: wp => real64, i8 => int64, sp => real32
  implicit none
  private
  public :: wp, i8, sp
end module kinds
