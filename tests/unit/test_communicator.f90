!> Sums, maxima and broadcasts over the ranks, on any number of them.
program test_communicator
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use kinds, only: wp, i8
  implicit none

  type(communicator_t) :: comm
  character(len=:), allocatable :: text
  integer :: n, incoming(0:63)
  integer(i8) :: offset

  call start_ranks(comm)
  n = comm%size
  offset = comm%before(10_i8)
  incoming(0:n - 1) = comm%swap_counts(spread(comm%rank, 1, n))
  if (comm%is_root()) text = 'seven..'
  call comm%broadcast(text)
  if (.not. comm%is_root()) then
    call stop_ranks()
    stop
  end if
  call expect_close(real(offset, wp), 0.0_wp, 0.0_wp, 'nothing is before the root')
  call expect(text == 'seven..', 'a text reaches every rank')
  call expect(all(incoming(0:n - 1) == [(offset, offset=0, n - 1)]), 'counts are swapped')
  call finish()
  call stop_ranks()
end program test_communicator
