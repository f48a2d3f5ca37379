!> An ideal gas: at rest under gravity, filling a vessel, swinging in a tube, pressed through beds.
program verify_compressible
  use check, only: expect, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use compressible_flows, only: atmosphere_error, filled_vessel, sound, bed_error, ergun_error, specific
  use kinds, only: wp
  use report, only: check_value
  implicit none

  real(wp), parameter :: none = 0.0_wp
  type(communicator_t) :: comm

  call start_ranks(comm)
  call columns()
  call vessel()
  call tube()
  call beds()
  call finish()
  call stop_ranks()

contains

  subroutine columns()
    real(wp) :: error(3)
    logical :: ok(3)

    call atmosphere_error(comm, 2, 32, .true., error(1), ok(1))
    call atmosphere_error(comm, 2, 64, .true., error(2), ok(2))
    call atmosphere_error(comm, 2, 64, .false., error(3), ok(3))
    call expect(all(ok), 'all converge')
    call check_value('ideal_column_open', 100*error(2), none)
    call check_value('ideal_column_closed', 100*error(3), none)
    call check_value('ideal_column_order', order(error(1:2)), 2.0_wp)
  end subroutine columns

  subroutine vessel()
    real(wp) :: pressure, mass
    logical :: ok

    call filled_vessel(comm, pressure, mass, ok)
    call expect(ok, 'it converges')
    call check_value('ideal_filling_pressure', pressure, 1.0_wp)
    call check_value('ideal_filling_mass', mass, 1.0_wp)
  end subroutine vessel

  subroutine tube()
    real(wp) :: frequency, distance
    logical :: ok

    call sound(comm, 2, 64, 400, frequency, distance, ok)
    call expect(ok, 'it converges')
    call check_value('ideal_sound', frequency, 0.5_wp*sqrt(specific))
    call check_value('ideal_sound_steps', 100*distance, none)
  end subroutine tube

  subroutine beds()
    real(wp) :: error(2, 2)
    logical :: ok(2, 2)
    integer :: level, iterations

    do level = 1, 2
      call bed_error(comm, 2, 20*level, error(level, 1), ok(level, 1), iterations)
      call ergun_error(comm, 20*level, error(level, 2), ok(level, 2))
    end do
    call expect(all(ok), 'all converge')
    call check_value('ideal_bed', 100*error(2, 1), none)
    call check_value('ideal_bed_order', order(error(:, 1)), 2.0_wp)
    call check_value('ideal_grains', 100*error(2, 2), none)
    call check_value('ideal_grains_order', order(error(:, 2)), 2.0_wp)
  end subroutine beds

  !> Of accuracy, from cells half as wide.
  pure function order(error)
    real(wp), intent(in) :: error(2)
    real(wp) :: order

    order = log(error(1)/error(2))/log(2.0_wp)
  end function order

end program verify_compressible
