!> The width over which parcels and gas meet, and what the gas feels when a parcel crosses from cell to cell.
program verify_spreading
  use boundary_settings, only: boundary_settings_t
  use check, only: finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use constants, only: pi
  use coupling_scene, only: scene_t, build, add, refill, recouple
  use coupling_settings, only: coupling_settings_t
  use kinds, only: wp
  use parcels, only: velocity_row
  use report, only: check_value, point
  implicit none

  integer, parameter :: per_cell = 32  !< steps
  integer, parameter :: crossed = 4    !< cells
  type(communicator_t) :: comm

  call start_ranks(comm)
  call variance('linear', 6.0e-3_wp)
  call variance('cell', 6.0e-3_wp)
  call crossing('cell', 'cell')
  call crossing('linear', 'linear')
  call crossing('linear', 'half', 0.5_wp)
  call crossing('linear', 'one', 1.0_wp)
  call crossing('linear', 'two', 2.0_wp)
  call crossing('cell', 'cell_one', 1.0_wp)
  call finish()
  call stop_ranks()

contains

  !> Of the volume of a parcel about its centre, in y, mean over places in a cell, over the width squared.
  subroutine variance(mapping, width)
    character(len=*), intent(in) :: mapping
    real(wp), intent(in) :: width  !< [m]

    integer, parameter :: places = 64
    type(coupling_settings_t) :: settings
    type(scene_t) :: scene
    real(wp) :: total, y, volume
    integer :: i, j

    call build(comm, 0.1_wp, [20, 40, 20], [.false., .false., .false.], 'wen_yu', scene)
    settings%mapping = mapping
    settings%width = width
    call recouple(scene, settings)
    call add(scene, [0.051_wp, 0.1_wp, 0.05_wp], spread(0.0_wp, 1, 3), 1.0e-3_wp, 1000.0_wp, 1.0_wp)
    volume = pi/6*1.0e-9_wp
    total = 0.0_wp
    do i = 1, places
      y = 0.1_wp + (i - 0.5_wp)/places*scene%mesh%finest(2)
      scene%parcels%state(2, 1) = y
      call scene%coupling%map_void_fraction(scene%parcels, scene%gas)
      do j = 1, 40
        total = total + sum(1 - scene%gas%eps(1:20, j, 1:20))*product(scene%mesh%finest)/volume &
          *((j - 0.5_wp)*scene%mesh%finest(2) - y)**2
      end do
    end do
    call scene%gas%destroy()
    call check_value('width_'//mapping, total/places/width**2, 1.0_wp)
  end subroutine variance

  !> A sheet of solids, a fifth of a cell, sinks at 0.1 m/s against gas that rises at 0.3 m/s in a column one cell across: the
  !> largest deviation of the pressure drop from its mean, over the mean [%], and the amplitudes of the multiples of the
  !> frequency of crossing.
  subroutine crossing(mapping, name, cells)
    character(len=*), intent(in) :: mapping, name
    real(wp), intent(in), optional :: cells  !< width over the height of a cell, none unless given

    type(coupling_settings_t) :: settings
    type(scene_t) :: scene
    real(wp) :: drop(1 - per_cell:per_cell*crossed), mean
    complex(wp) :: wave
    integer :: i, k, n

    settings%mapping = mapping
    if (present(cells)) settings%width = cells*2.0e-3_wp
    call make_column(settings, scene)
    call sink(scene, drop)
    call scene%gas%destroy()
    n = per_cell*crossed
    mean = sum(drop(1:))/n
    call check_value('crossing_'//name, 100*maxval(abs(drop(1:)/mean - 1)), 0.0_wp)
    do i = 1, 2*per_cell
      call point('crossing_'//name, real(i, wp)/per_cell, drop(i)/mean, 1.0_wp)
    end do
    do k = 1, per_cell/2 - 1
      wave = sum([(drop(i)*exp(cmplx(0.0_wp, -2*pi*k*i/per_cell, wp)), i=1, n)])/n
      call point('crossing_spectrum_'//name, real(k, wp), 2*abs(wave)/mean, 0.0_wp)
    end do
  end subroutine crossing

  subroutine make_column(settings, scene)
    type(coupling_settings_t), intent(in) :: settings
    type(scene_t), intent(out) :: scene

    type(boundary_settings_t) :: records(2)

    call build(comm, 0.016_wp, [1, 16, 1], [.true., .false., .true.], 'wen_yu', scene)
    records(1)%kind = 'inflow'
    records(1)%velocity = 0.3_wp
    records(1)%lower = 0.0_wp
    records(1)%upper = [0.016_wp, 0.0_wp, 0.016_wp]
    records(2)%kind = 'outflow'
    records(2)%lower = [0.0_wp, 0.032_wp, 0.0_wp]
    records(2)%upper = [0.016_wp, 0.032_wp, 0.016_wp]
    call refill(scene, records)
    call recouple(scene, settings)
    call add(scene, [0.008_wp, 0.022_wp, 0.008_wp], spread(0.0_wp, 1, 3), 5.0e-4_wp, 2500.0_wp, &
             0.2_wp*product(scene%mesh%finest)*6/(pi*5.0e-4_wp**3))
  end subroutine make_column

  !> The pressure drop while the sheet sinks through some cells; the first, to forget the start, has numbers below 1.
  subroutine sink(scene, drop)
    type(scene_t), intent(inout) :: scene
    real(wp), intent(out) :: drop(1 - per_cell:)  !< [Pa]

    real(wp), parameter :: speed = 0.1_wp
    real(wp) :: dt
    logical :: converged
    integer :: i

    dt = scene%mesh%finest(2)/(per_cell*speed)
    do i = lbound(drop, 1), ubound(drop, 1)
      scene%parcels%state(velocity_row:velocity_row + 2, 1) = [0.0_wp, -speed, 0.0_wp]
      call scene%coupling%map_void_fraction(scene%parcels, scene%gas)
      if (i == lbound(drop, 1)) call scene%gas%accept()
      call scene%coupling%prepare(scene%parcels, scene%gas, dt, as_seen=.false.)
      call scene%gas%advance(dt, converged)
      if (.not. converged) error stop 'verify_spreading: the gas does not converge'
      call scene%gas%accept()
      call scene%coupling%drive(scene%parcels, scene%gas, dt)
      drop(i) = scene%gas%pressure(1, 1, 1)
      scene%parcels%state(2, 1) = scene%parcels%state(2, 1) - speed*dt
    end do
  end subroutine sink

end program verify_spreading
