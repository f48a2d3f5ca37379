!> Where in an array a cache line begins. `allocate` does not promise that the first element is such a place, so whether columns of
!> eight reals lie on one line each or on two would be a matter of chance; where they are added to all the time two are slow.
module cache_lines
  use, intrinsic :: iso_c_binding, only: c_loc, c_intptr_t
  use kinds, only: wp
  implicit none
  private
  public :: line_start, line_reals

  integer, parameter :: real_bytes = storage_size(1.0_wp)/8
  integer, parameter :: line_reals = 64/real_bytes

contains

  !> The first element that begins a line, one of the first `line_reals`.
  function line_start(array) result(first)
    real(wp), intent(in), target :: array(:)  !< (line_reals at least)
    integer :: first

    integer(c_intptr_t) :: address

    address = transfer(c_loc(array(1)), address)
    first = 1 + int(modulo(-address/real_bytes, int(line_reals, c_intptr_t)))
  end function line_start

end module cache_lines
