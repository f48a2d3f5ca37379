!> The cavity with a moving lid on 128 by 128 cells, Re 100, 400 and 1000, with the default limiter.
! long: about a minute, so `make verify` alone runs it; tests/unit/test_gas_boundary.f90 has a small cavity.
program verify_cavity
  use cavity_flow, only: cavity_t, steady_cavity
  use check, only: expect, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use ghia_cavity, only: reynolds, misprint, ghia_u => u, ghia_v => v, ghia_x => x, ghia_y => y
  use kinds, only: wp
  use report, only: check_value, point
  implicit none

  !> Extremes of u(y) and v(x). Re 1000: spectral, Botella and Peyret, Comput. Fluids 27 (1998) 421. Re 100: the same values
  !> as 1024 by 1024 cells extrapolated, Marchi, Suero and Araki, J. Braz. Soc. Mech. Sci. Eng. 31 (2009) 186, to 1e-6.
  real(wp), parameter :: u_min(3) = [-0.2140424_wp, 0.0_wp, -0.3885698_wp]
  real(wp), parameter :: v_max(3) = [0.1795728_wp, 0.0_wp, 0.3769447_wp]
  real(wp), parameter :: v_min(3) = [-0.2538030_wp, 0.0_wp, -0.5270771_wp]

  type(communicator_t) :: comm
  type(cavity_t) :: flow, coarse
  integer :: m
  character(len=16) :: name

  call start_ranks(comm)
  do m = 1, size(reynolds)
    call steady_cavity(comm, 128, reynolds(m), 'van_leer', 0.25_wp, 2.0e-6_wp, flow)
    call expect(flow%steady, 'a steady flow')
    write (name, '(i0)') nint(reynolds(m))
    call compare_ghia(trim(name), flow, m)
    if (abs(u_min(m)) > 0.0_wp) call compare_extremes(trim(name), flow, m)
    if (m > 1) cycle
    call steady_cavity(comm, 64, reynolds(m), 'van_leer', 0.25_wp, 2.0e-6_wp, coarse)
    call check_value('cavity_order', log((coarse%u_min() - u_min(m))/(flow%u_min() - u_min(m)))/log(2.0_wp), 2.0_wp)
  end do
  call finish()
  call stop_ranks()

contains

  !> The largest distance from Ghia's values; and both lines, of which a picture is made.
  subroutine compare_ghia(name, flow, m)
    character(len=*), intent(in) :: name
    type(cavity_t), intent(in) :: flow
    integer, intent(in) :: m

    real(wp) :: worst(2), found
    integer :: i

    worst = 0.0_wp
    do i = 1, size(ghia_y)
      found = flow%at(flow%u, ghia_y(i))
      worst(1) = max(worst(1), abs(found - ghia_u(i, m)))
      call point('cavity_u_'//name, ghia_y(i), found, ghia_u(i, m))
    end do
    do i = 1, size(ghia_x)
      found = flow%at(flow%v, ghia_x(i))
      call point('cavity_v_'//name, ghia_x(i), found, ghia_v(i, m))
      if (all([i, m] == misprint)) cycle
      worst(2) = max(worst(2), abs(found - ghia_v(i, m)))
    end do
    do i = 1, size(flow%place)
      call point('cavity_lines_'//name, flow%place(i), flow%u(i), flow%v(i))
    end do
    call check_value('cavity_u_'//name, worst(1), 0.0_wp)
    call check_value('cavity_v_'//name, worst(2), 0.0_wp)
  end subroutine compare_ghia

  subroutine compare_extremes(name, flow, m)
    character(len=*), intent(in) :: name
    type(cavity_t), intent(in) :: flow
    integer, intent(in) :: m

    call check_value('cavity_u_min_'//name, flow%u_min(), u_min(m))
    call check_value('cavity_v_max_'//name, flow%v_max(), v_max(m))
    call check_value('cavity_v_min_'//name, flow%v_min(), v_min(m))
  end subroutine compare_extremes

end program verify_cavity
