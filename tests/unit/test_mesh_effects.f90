!> Resistance to rolling and attraction on walls of triangles.
!> ranks: 1
program test_mesh_effects
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use contact_settings, only: contact_settings_t
  use des_scenes, only: put, run
  use kinds, only: wp
  use mesh_scenes, only: mesh_room, mesh, sheet
  use solids, only: solids_t
  use sticky_balls, only: r, m, k, a, near, far, sticky
  use surface, only: new_surface
  use wall_scenes, only: column, g, material, mass_of
  implicit none

  type(communicator_t) :: comm
  real(wp), parameter :: radius = 0.5e-3_wp, stiffness = 200.0_wp

  call start_ranks(comm)
  call over_triangles('spring')
  call over_triangles('constant_torque')
  call hangs_from_triangles()
  call finish()
  call stop_ranks()

contains

  !> Over a sheet of triangles a ball rolls as on a floor: the angle goes with it from one to the next.
  subroutine over_triangles(rolling)
    character(len=*), intent(in) :: rolling

    real(wp), parameter :: mu = 0.05_wp, speed = 0.1_wp, middle = 5.0e-3_wp, half = 1.0e-2_wp
    real(wp), parameter :: along(3) = [half, 0.0_wp, 0.0_wp], b(3) = [0.0_wp, half, 0.0_wp], low(3) = [0.0_wp, 0.0_wp, middle]
    type(solids_t) :: ball
    type(contact_settings_t) :: contact
    real(wp) :: dt, before(2), after(2), dent

    contact = material(stiffness, 0.5_wp, 0.8_wp)
    contact%rolling = rolling
    contact%rolling_friction = mu
    ball = mesh_room(comm, half, [0.0_wp, 0.0_wp, -g], contact, [mesh()], &
                     [new_surface(sheet(low, along, b, [20, 20], 0.3_wp))])
    dent = mass_of(2*radius)*g/stiffness
    call put(ball, column([2.0e-3_wp, middle, middle + radius - dent]), column([speed, 0.0_wp, 0.0_wp]), [2*radius])
    ball%parcels%state(10, 1) = speed
    dt = ball%time_step_limit()
    call run(ball, nint(0.01_wp/dt), dt)
    before = [ball%time, ball%parcels%state(5, 1)]
    call run(ball, nint(0.02_wp/dt), dt)
    after = [ball%time, ball%parcels%state(5, 1)]
    call expect_close((before(2) - after(2))/(after(1) - before(1)), 5*mu*g/7, 2.0e-3_wp, rolling//' brakes on triangles, too')
  end subroutine over_triangles

  !> Triangles, seen from below, hold a ball as the ceiling does.
  subroutine hangs_from_triangles()
    real(wp), parameter :: most = a*r/(6*near**2), up = 0.7e-3_wp, edge = 1.0e-3_wp
    type(solids_t) :: ball
    real(wp) :: share, dent, x(3, 1)
    integer :: i

    do i = 1, 2
      share = merge(0.99_wp, 1.01_wp, i == 1)
      dent = max((1 - share)*most/k, 0.0_wp)
      ball = mesh_room(comm, edge, [0.0_wp, 0.0_wp, -share*most/m], sticky(0.5_wp), [mesh()], &
                       [new_surface(sheet([0.0_wp, 0.0_wp, up], [edge, 0.0_wp, 0.0_wp], [0.0_wp, edge, 0.0_wp], [7, 7], 0.2_wp))])
      x(:, 1) = [0.52e-3_wp, 0.47e-3_wp, up - r + dent]
      call put(ball, x, 0*x, [2*r])
      call run(ball, nint(5.0e-3_wp/ball%time_step_limit()), ball%time_step_limit())
      if (i == 1) call expect_close(ball%parcels%state(3, 1), up - r + dent, 1.0e-9_wp, 'a light ball hangs from triangles')
      if (i == 2) call expect(ball%parcels%state(3, 1) < up - r - far, 'a heavy ball falls off them')
    end do
  end subroutine hangs_from_triangles

end program test_mesh_effects
