!> One parcel in a prescribed gas: where it ends, and how, for every weight and every step, on any number of ranks.
program test_coupling
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use constants, only: pi
  use coupling_scene, only: scene_t, build, add, step, set_gas, gravity, viscosity, density
  use drag_beetstra, only: beetstra
  use drag_response, only: shares
  use kinds, only: wp
  use lone_grain, only: balanced_slip, grain_velocity, settled_velocity, transient_error
  use parcels, only: velocity_row, drag_row
  implicit none

  type(communicator_t) :: comm
  real(wp) :: weight(3) = [1.0_wp, 8.0_wp, 1000.0_wp], ratio(5) = [0.01_wp, 0.1_wp, 1.0_wp, 10.0_wp, 100.0_wp]
  integer :: i

  call start_ranks(comm)
  do i = 1, 3
    call check_terminal_velocity(weight(i), 'gidaspow')
    call check_terminal_velocity(weight(i), 'beetstra')
  end do
  do i = 1, 5
    call check_relaxation(ratio(i))
  end do
  do i = 1, 4
    call check_held(ratio(i))
  end do
  do i = 2, 5
    call check_yielding(ratio(i), 0.5_wp)
  end do
  call check_yielding(10.0_wp, 0.8_wp)
  call check_fast_grain()
  call check_transient(1.0e-3_wp, 5.0e-6_wp)
  call check_transient(1.0e-2_wp, 5.0e-4_wp)
  call check_shares()
  call check_changing_step()
  if (comm%is_root()) call finish()
  call stop_ranks()

contains

  !> r and q near the end of the series, against values computed with 30 digits.
  subroutine check_shares()
    real(wp) :: r, q

    if (.not. comm%is_root()) return
    call shares(1.0_wp, r, q)
    call expect_close(r, 1 - exp(-1.0_wp), 1e-15_wp, 'r at dt/tau = 1')
    call expect_close(q, exp(-1.0_wp)/(1 - exp(-1.0_wp)), 1e-15_wp, 'q at dt/tau = 1')
    call shares(0.1_wp, r, q)
    call expect_close(r, 0.095162581964040426_wp, 1e-15_wp, 'r at dt/tau = 0.1')
    call expect_close(q, 0.508331944775049624_wp, 1e-14_wp, 'q at dt/tau = 0.1')
    call shares(1.0e-9_wp, r, q)
    call expect_close(r, 1.0e-9_wp, 1e-9_wp, 'r at dt/tau = 1e-9')
    call expect_close(q, 0.5_wp, 1e-9_wp, 'q at dt/tau = 1e-9')
  end subroutine check_shares

  !> In gas that rises at 0.3 m/s; 100 um, 2000 kg/m3.
  subroutine check_terminal_velocity(weight, drag)
    real(wp), intent(in) :: weight
    character(len=*), intent(in) :: drag

    real(wp) :: v
    character(len=60) :: name

    v = settled_velocity(comm, weight, drag)
    write (name, '(3a,i0)') 'terminal velocity, ', drag, ', W = ', nint(weight)
    if (comm%is_root()) call expect_close(v, 0.3_wp - balanced_slip(1.0e-4_wp, 2000.0_wp, drag), 1.0e-6_wp, trim(name))
  end subroutine check_terminal_velocity

  !> Started at rest in creeping flow, a 20 um parcel goes monotonically to the velocity of the gas less its slip.
  subroutine check_relaxation(ratio)
    real(wp), intent(in) :: ratio  !< step over response time

    type(scene_t) :: scene
    real(wp) :: tau, v, before
    logical :: monotone
    integer :: i
    character(len=60) :: name

    call build(comm, 1.0e4_wp, [4, 8, 4], [.false., .false., .false.], 'gidaspow', scene, gas_density=1.0e-30_wp)
    call set_gas(scene, [0.0_wp, 0.1_wp, 0.0_wp], spread(0.0_wp, 1, 3))
    call add(scene, [3210.0_wp, 7700.0_wp, 5500.0_wp], spread(0.0_wp, 1, 3), 2.0e-5_wp, 1000.0_wp, 50.0_wp)
    tau = 1000.0_wp*4.0e-10_wp/(18*viscosity)
    monotone = .true.
    before = 0.0_wp
    do i = 1, 25
      call step(scene, ratio*tau)
      v = grain_velocity(scene)
      monotone = monotone .and. v >= before*(1 - 1e-14_wp)
      before = v
    end do
    write (name, '(a,f0.2)') 'relaxation at dt/tau = ', ratio
    if (.not. comm%is_root()) return
    call expect(monotone, trim(name)//' is monotone')
    call expect_close(v, (0.1_wp + tau*gravity(2))*(1 - exp(-25*ratio)), 1.0e-12_wp, trim(name)//' is exponential')
  end subroutine check_relaxation

  !> A 5 mm grain, whose drag grows with the square of its slip (Re = 6000), settles in steps of 100 response times.
  subroutine check_fast_grain()
    type(scene_t) :: scene
    real(wp) :: v, end_velocity, tau
    integer :: i

    call build(comm, 1.0e4_wp, [4, 8, 4], [.false., .false., .false.], 'gidaspow', scene)
    call add(scene, [3210.0_wp, 7700.0_wp, 5500.0_wp], spread(0.0_wp, 1, 3), 5.0e-3_wp, 2500.0_wp, 1.0_wp)
    end_velocity = -balanced_slip(5.0e-3_wp, 2500.0_wp, 'gidaspow')
    tau = end_velocity/gravity(2)
    do i = 1, 12
      call step(scene, 100*tau)
    end do
    v = grain_velocity(scene)
    if (comm%is_root()) call expect_close(v, end_velocity, 1.0e-6_wp, 'a fast coarse grain settles at dt/tau = 100')
  end subroutine check_fast_grain

  !> A grain that starts at rest.
  subroutine check_transient(dt, tolerance)
    real(wp), intent(in) :: dt         !< [s]
    real(wp), intent(in) :: tolerance  !< of the final speed [-]

    real(wp) :: error
    character(len=80) :: name

    error = transient_error(comm, dt)
    write (name, '(a,f0.4,a)') 'a grain that starts at rest, dt = ', dt, ' s, error over final speed'
    if (comm%is_root()) call expect_close(error, 0.0_wp, tolerance, trim(name))
  end subroutine check_transient

  !> A parcel that contacts hold in place feels the drag of the full slip.
  subroutine check_held(ratio)
    real(wp), intent(in) :: ratio  !< step over response time

    type(scene_t) :: scene
    real(wp) :: tau, beta, reynolds, force
    integer :: i
    character(len=60) :: name

    call build(comm, 1.0e4_wp, [4, 8, 4], [.false., .false., .false.], 'beetstra', scene)
    call set_gas(scene, [0.0_wp, 0.1_wp, 0.0_wp], spread(0.0_wp, 1, 3))
    call add(scene, [3210.0_wp, 7700.0_wp, 5500.0_wp], spread(0.0_wp, 1, 3), 2.0e-5_wp, 1000.0_wp, 50.0_wp)
    tau = 1000.0_wp*4.0e-10_wp/(18*viscosity)
    reynolds = density*0.1_wp*2.0e-5_wp/viscosity
    beta = 3*pi*viscosity*2.0e-5_wp*beetstra(reynolds, 1.0_wp)
    do i = 1, 30 + nint(20*ratio)
      call step(scene, ratio*tau)
      scene%parcels%state(velocity_row:velocity_row + 2, :scene%parcels%n) = 0.0_wp
    end do
    force = scene%coupling%exchange%drag(2)
    write (name, '(a,f0.2)') 'a held parcel feels its full drag at dt/tau = ', ratio
    if (comm%is_root()) call expect_close(force, 50*beta*0.1_wp, 1.0e-6_wp, trim(name))
  end subroutine check_held

  !> Contacts that undo a share of the drag within each step: the parcel settles where the rest carries its weight.
  subroutine check_yielding(ratio, share)
    real(wp), intent(in) :: ratio  !< step over response time
    real(wp), intent(in) :: share  !< of the drag [-]

    type(scene_t) :: scene
    real(wp) :: tau, slip
    integer :: i, n
    character(len=60) :: name

    call build(comm, 1.0e4_wp, [4, 8, 4], [.false., .false., .false.], 'gidaspow', scene)
    call add(scene, [3210.0_wp, 7700.0_wp, 5500.0_wp], spread(0.0_wp, 1, 3), 2.0e-5_wp, 1000.0_wp, 50.0_wp)
    slip = balanced_slip(2.0e-5_wp, 1000.0_wp/(1.0_wp - share), 'gidaspow')
    tau = 1000.0_wp*4.0e-10_wp/(18*viscosity)
    n = scene%parcels%n
    do i = 1, 40 + nint(20*(ratio + 1/ratio)/(1 - share))
      call step(scene, ratio*tau)
      scene%parcels%state(velocity_row:velocity_row + 2, :n) = scene%parcels%state(velocity_row:velocity_row + 2, :n) &
        - share*ratio*tau*scene%parcels%coupled(drag_row:drag_row + 2, :n)
    end do
    slip = slip + grain_velocity(scene)
    write (name, '(2(a,f0.2))') 'contacts undo a share ', share, ' of the drag, dt/tau = ', ratio
    if (comm%is_root()) call expect_close(slip, 0.0_wp, 1.0e-7_wp, trim(name))
  end subroutine check_yielding

  !> Steps of changing length do not disturb a parcel at its terminal velocity.
  subroutine check_changing_step()
    type(scene_t) :: scene
    real(wp) :: tau, v, worst, end_velocity
    integer :: i

    call build(comm, 1.0e4_wp, [4, 8, 4], [.false., .false., .false.], 'gidaspow', scene)
    call add(scene, [3210.0_wp, 7700.0_wp, 5500.0_wp], spread(0.0_wp, 1, 3), 2.0e-5_wp, 1000.0_wp, 50.0_wp)
    end_velocity = -balanced_slip(2.0e-5_wp, 1000.0_wp, 'gidaspow')
    tau = 1000.0_wp*4.0e-10_wp/(18*viscosity)
    do i = 1, 30
      call step(scene, 5*tau)
    end do
    worst = 0.0_wp
    do i = 1, 20
      call step(scene, tau*5.0_wp**modulo(i, 3))
      v = grain_velocity(scene)
      worst = max(worst, abs(v - end_velocity))
    end do
    if (comm%is_root()) call expect(worst < 1.0e-6_wp*abs(end_velocity), 'steps of changing length keep the terminal velocity')
  end subroutine check_changing_step

end program test_coupling
