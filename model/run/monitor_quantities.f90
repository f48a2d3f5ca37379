!> What a monitor can measure: the names a case file may use, with units and meanings.
module monitor_quantities
  implicit none
  private
  public :: quantity_t, quantities, monitor_kinds, find_quantity, fits_kind

  type :: quantity_t
    character(len=24) :: name     !< as in the case file
    character(len=8) :: unit
    integer :: components         !< 1, or 3 for a vector
    logical :: of_gas             !< of the gas; otherwise of the parcels
    logical :: is_flux            !< through a plane, positive along its normal axis; only planes have it
    character(len=96) :: meaning
  end type quantity_t

  !> Regions. For parcels a point, a line and a plane are one gas cell thick.
  character(len=5), parameter :: monitor_kinds(4) = ['point', 'line ', 'plane', 'box  ']

  type(quantity_t), parameter :: quantities(18) = [ &
    quantity_t('pressure', 'Pa', 1, .true., .false., 'gas pressure'), &
    quantity_t('void_fraction', '1', 1, .true., .false., 'volume fraction of the gas'), &
    quantity_t('gas_velocity', 'm/s', 3, .true., .false., 'velocity of the gas between the particles'), &
    quantity_t('superficial_velocity', 'm/s', 3, .true., .false., 'void fraction times gas velocity'), &
    quantity_t('gas_density', 'kg/m3', 1, .true., .false., 'density of an ideal gas'), &
    quantity_t('gas_mass_flux', 'kg/s', 1, .true., .true., 'gas through the plane'), &
    quantity_t('solids_volume_fraction', '1', 1, .false., .false., &
    'volume of the particles whose parcel has its centre in the region, over its open volume'), &
    quantity_t('parcel_velocity', 'm/s', 3, .false., .false., 'mass-weighted mean velocity of the parcels'), &
    quantity_t('parcel_count', '1', 1, .false., .false., 'number of parcels'), &
    quantity_t('particle_count', '1', 1, .false., .false., 'number of real particles, the sum of the weights'), &
    quantity_t('parcel_mass', 'kg', 1, .false., .false., 'mass of the parcels'), &
    quantity_t('mean_position', 'm', 3, .false., .false., 'centre of mass of the parcels'), &
    quantity_t('mean_diameter', 'm', 1, .false., .false., 'number mean diameter of the real particles'), &
    quantity_t('sauter_diameter', 'm', 1, .false., .false., 'sum of d^3 over sum of d^2 of the real particles'), &
    quantity_t('kinetic_energy', 'J', 1, .false., .false., 'energy of translation of the parcels'), &
    quantity_t('granular_temperature', 'm2/s2', 1, .false., .false., &
    'a third of the mass-weighted variance of the velocity'), &
    quantity_t('parcel_mass_flux', 'kg/s', 1, .false., .true., &
    'mass times normal velocity of the parcels in a layer, over its thickness'), &
    quantity_t('particle_flux', '1/s', 1, .false., .true., &
    'real particles through the plane, from the same layer')]

contains

  !> Place of a name in `quantities`, 0 if it is not known.
  pure function find_quantity(name) result(place)
    character(len=*), intent(in) :: name
    integer :: place

    do place = size(quantities), 1, -1
      if (quantities(place)%name == name) return
    end do
  end function find_quantity

  !> Whether the quantity at `place` can be measured in a region of this kind.
  pure function fits_kind(place, kind)
    integer, intent(in) :: place
    character(len=*), intent(in) :: kind
    logical :: fits_kind

    fits_kind = any(monitor_kinds == kind) .and. (kind == 'plane' .or. .not. quantities(place)%is_flux)
  end function fits_kind

end module monitor_quantities
