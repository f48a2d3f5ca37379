!> Flow with eddies smaller than the cells whose mixing length is held: between plates, and in a pipe that cuts cells.
program verify_turbulence
  use check, only: expect, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use eddy_flows, only: channel_error, channel_velocity, gap, pipe_error, shear_force
  use kinds, only: wp
  use report, only: check_value
  implicit none

  type(communicator_t) :: comm

  call start_ranks(comm)
  call plates()
  call shear()
  call pipes()
  call finish()
  call stop_ranks()

contains

  !> On 128 and 256 cells.
  subroutine plates()
    real(wp) :: error(2)
    logical :: ok(2)

    call channel_error(comm, 1, 2, 128, error(1), ok(1))
    call channel_error(comm, 1, 2, 256, error(2), ok(2))
    call expect(all(ok), 'both converge')
    call check_value('eddies_plates_order', log(error(1)/error(2))/log(2.0_wp), 2.0_wp)
    call check_value('eddies_plates', 100*error(2)/channel_velocity(gap/2), 0.0_wp)
  end subroutine plates

  subroutine shear()
    real(wp) :: worst, force
    logical :: ok

    call shear_force(comm, 1, 2, 8, worst, force, ok)
    call expect(ok, 'it converges')
    call check_value('eddies_shear', worst, 0.0_wp)
    call check_value('eddies_shear_force', force, 1.0_wp)
  end subroutine shear

  !> On 8, 16 and 32 cells across.
  subroutine pipes()
    real(wp) :: error(3)
    logical :: ok
    integer :: level

    do level = 1, 3
      call pipe_error(comm, 4*2**level, error(level), ok)
      call expect(ok, 'it converges')
    end do
    call check_value('eddies_pipe_order', 100*maxval(abs(error)*[1, 4, 16]), 0.0_wp)
    call check_value('eddies_pipe', 100*error(3), 0.0_wp)
  end subroutine pipes

end program verify_turbulence
