!> Inflows by tables over space.
program test_inflow_profile
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use gas, only: gas_t
  use gas_cases, only: scene_t, record, channel, make_gas, steps
  use inflow_profile, only: new_inflow_profile
  use kinds, only: wp
  use outcome, only: outcome_t
  use problems, only: problems_t
  implicit none

  real(wp), parameter :: o = 0.0_wp, edge = 2.0e-3_wp
  real(wp), parameter :: kink = 4.3_wp*edge, across(2) = [o, 8*edge], along(2) = [o, 4*edge]
  type(communicator_t) :: comm

  call start_ranks(comm)
  call tables_of_inflow()
  call poiseuille_by_table()
  if (comm%is_root()) call finish()
  call stop_ranks()

contains

  !> A table along one coordinate with a kink within a face, and one on a lattice in two, given in a strange order: each face
  !> has the mean over itself, so that the flow is the integral; a mass flow multiplies it, and factors do as well.
  subroutine tables_of_inflow()
    real(wp), parameter :: corners(2, 4) = reshape([across(2), along(1), across(1), along(1), across(1), along(2), across(2), &
                                                    along(2)], [2, 4])
    type(scene_t) :: scene
    type(problems_t) :: problems
    real(wp) :: flow(8, 4)
    integer :: i, k, m

    do m = 1, 3
      scene = channel(edge)
      scene%records(1)%velocity = -huge(1.0_wp)
      scene%records(1)%profile = 'table'
      if (m < 3) then
        call new_inflow_profile([1], reshape([across(1), kink, across(2)], [1, 3]), [0.2_wp, 0.9_wp, 0.1_wp], &
                                scene%records(1)%table, 'kink', problems)
        flow = spread([(hat(i*edge) - hat((i - 1)*edge), i=1, 8)], 2, 4)*edge
        if (m == 2) scene%records(1)%mass_flow = 3.0e-5_wp
        if (m == 2) flow = flow*(3.0e-5_wp/1.2_wp)/sum(flow)
      else
        call new_inflow_profile([1, 3], corners, [0.7_wp, 0.1_wp, 0.4_wp, 0.2_wp], scene%records(1)%table, 'lattice', problems)
        do k = 1, 4
          flow(:, k) = [(bilinear((i - 0.5_wp)/8, (k - 0.5_wp)/4), i=1, 8)]*edge**2
        end do
      end if
      call compare_inflow(scene, flow, problems)
    end do
  end subroutine tables_of_inflow

  !> Integral of the table with the kink from 0 [m2/s].
  pure function hat(x)
    real(wp), intent(in) :: x  !< [m]
    real(wp) :: hat

    real(wp) :: s

    s = max(o, x - kink)
    hat = 0.2_wp*min(x, kink) + 0.35_wp*min(x, kink)**2/kink + 0.9_wp*s - 0.4_wp*s**2/(across(2) - kink)
  end function hat

  pure function bilinear(s, t) result(u)
    real(wp), intent(in) :: s, t
    real(wp) :: u

    u = (0.1_wp*(1 - s) + 0.7_wp*s)*(1 - t) + (0.4_wp*(1 - s) + 0.2_wp*s)*t
  end function bilinear

  !> A step of a channel with a table whose factor is half-way from 1 to 2, on grids moved against the boxes.
  subroutine compare_inflow(scene, flow, problems)
    type(scene_t), intent(inout) :: scene
    real(wp), intent(in) :: flow(8, 4)  !< of the faces, where the factor is 1 [m3/s]
    type(problems_t), intent(in) :: problems

    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: worst
    logical :: converged

    scene%records(1)%times = [o, 2.0e-3_wp]
    scene%records(1)%factors = [1.0_wp, 2.0_wp]
    call make_gas(comm, scene, gas, outcome)
    call gas%advance(1.0e-3_wp, converged)
    worst = o
    if (gas%boxes%lo(2) == 1) then
      associate (lo => gas%boxes%lo, hi => gas%boxes%hi, n => gas%boxes%n)
        worst = maxval(abs(gas%velocity(1:n(1), 0, 1:n(3), 2)*edge**2 - 1.5_wp*flow(lo(1):hi(1), lo(3):hi(3))))
      end associate
    end if
    worst = comm%max(worst)
    if (comm%is_root()) then
      call expect(problems%count() == 0 .and. converged, 'a table flows in')
      call expect_close(worst, o, 1.0e-14_wp*maxval(flow), 'the inflow of faces by a table [m3/s]')
      call expect_close(gas%report%inflow, 1.5_wp*1.2_wp*sum(flow), 1.0e-13_wp, 'all of it [kg/s]')
    end if
    call gas%destroy()
  end subroutine compare_inflow

  !> The parabola between plates by a table is the developed flow: it stays as it came in.
  subroutine poiseuille_by_table()
    integer, parameter :: points = 161
    real(wp), parameter :: mean = 0.1_wp, gap = 16*edge
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    type(problems_t) :: problems
    real(wp) :: place(1, points), worst
    integer :: m, i, j
    logical :: ok

    scene%cells = [16, 12, 1]
    scene%upper = scene%cells*edge
    scene%periodic = [.false., .false., .true.]
    scene%settings%viscosity = 1.0e-3_wp
    scene%numerics%velocity_tolerance = 1.0e-9_wp
    allocate (scene%records(2))
    associate (top => scene%upper)
      scene%records(1) = record('in', 'inflow', [o, o, o], [top(1), o, top(3)])
      scene%records(2) = record('out', 'outflow', [o, top(2), o], top)
    end associate
    place(1, :) = [(m*gap/(points - 1), m=0, points - 1)]
    scene%records(1)%profile = 'table'
    call new_inflow_profile([1], place, 6*mean*place(1, :)*(gap - place(1, :))/gap**2, scene%records(1)%table, 'plates', problems)
    call make_gas(comm, scene, gas, outcome)
    ok = steps(gas, 30, 0.05_wp)
    worst = o
    do j = 1, gas%boxes%n(2)
      do i = 1, gas%boxes%n(1)
        associate (s => (gas%boxes%lo(1) + i - 1.5_wp)/16)
          worst = max(worst, abs(gas%velocity(i, j, 1, 2) - 6*mean*s*(1 - s)))
        end associate
      end do
    end do
    worst = comm%max(worst)
    if (comm%is_root()) then
      call expect(ok .and. problems%count() == 0, 'the flow between plates converges')
      call expect_close(worst, o, 4.0e-3_wp*mean, 'a parabola by a table is the developed flow [m/s]')
      call expect_close(gas%report%inflow, 1.2_wp*mean*gap*edge, 1.0e-4_wp, 'and as much as it says [kg/s]')
    end if
    call gas%destroy()
  end subroutine poiseuille_by_table

end program test_inflow_profile
