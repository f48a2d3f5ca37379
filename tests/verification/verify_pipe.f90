!> Laminar flow in pipes whose walls cut through cells.
program verify_pipe
  use check, only: expect, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use kinds, only: wp
  use pipe_flow, only: pipe_flow_error, turned_duct_error
  use report, only: check_value, point
  implicit none

  integer, parameter :: cells(3) = [8, 16, 32]
  type(communicator_t) :: comm
  real(wp) :: round(3), turned(3), imbalance
  real(wp), allocatable :: profile(:,:)
  character(len=2) :: name
  integer :: m, i
  logical :: ok

  call start_ranks(comm)
  do m = 1, 3
    write (name, '(i0)') cells(m)
    call pipe_flow_error(comm, cells(m), round(m), imbalance, ok, profile=profile)
    call expect(ok .and. imbalance < 1.0e-9_wp, 'the pipe converges')
    call check_value('pipe_'//trim(name), 100*round(m), 0.0_wp)
    do i = 1, size(profile, 2)
      call point('pipe_profile_'//trim(name), profile(1, i), profile(2, i), 1 - profile(1, i)**2)
    end do
    call turned_duct_error(comm, cells(m), turned(m), ok)
    call expect(ok, 'the duct converges')
    call check_value('turned_duct_'//trim(name), 100*turned(m), 0.0_wp)
  end do
  call check_value('pipe_order', log(round(2)/round(3))/log(2.0_wp), 2.0_wp)
  call check_value('turned_duct_order', log(turned(2)/turned(3))/log(2.0_wp), 2.0_wp)
  do m = 1, 3
    call point('pipe_errors', 1.0_wp/cells(m), 100*round(m), 100*round(3)*(32.0_wp/cells(m))**2)
    call point('turned_duct_errors', 1.0_wp/cells(m), 100*turned(m), 100*turned(3)*(32.0_wp/cells(m))**2)
  end do
  call finish()
  call stop_ranks()

end program verify_pipe
