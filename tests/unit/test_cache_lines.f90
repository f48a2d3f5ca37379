!> Where cache lines begin.
program test_cache_lines
  use, intrinsic :: iso_c_binding, only: c_loc, c_intptr_t
  use cache_lines, only: line_start, line_reals
  use check, only: expect, finish
  use kinds, only: wp
  implicit none

  real(wp), target :: array(64)
  integer(c_intptr_t) :: address
  integer :: k, first

  array = 0.0_wp
  do k = 1, 2*line_reals
    first = line_start(array(k:))
    address = transfer(c_loc(array(k + first - 1)), address)
    call expect(modulo(address, 64_c_intptr_t) == 0, 'begins with a line of 64 bytes')
    call expect(first >= 1 .and. first <= line_reals, 'the first of them')
  end do
  call finish()

end program test_cache_lines
